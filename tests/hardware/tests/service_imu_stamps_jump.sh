#!/usr/bin/env bash
# Samples whose stamps jump by seconds are not believed until they go on steadily; then they are put where they
# belong, and it is said.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

samples() { status_of .imu.samples; }
have_come() { (($(samples) >= $1)); }
has_jumped() { status_of '.imu.remarks[]' | grep -q "its clock jumped $1 time"; }
expect_samples_go_on() { wait_until "samples go on" have_come $(($(samples) + 100)); }

start_usual_service
expect_equal "remarks" "$(status_of '.imu.remarks | length')" 0

change_clock_of_recorded_imu
wait_until "it is said" has_jumped 1
expect_samples_go_on
expect_pictures_go_on
wait_until "all is well" is_not_degraded passing-through

change_clock_of_recorded_imu
wait_until "it is said again" has_jumped 2
expect_samples_go_on
expect_pictures_go_on
wait_until "all is well" is_not_degraded passing-through
expect_equal "what does not work" "$(degraded)" ""
expect_equal "samples off the clock" "$(status_of .imu.samples_off_clock)" 0
expect_equal "process" "$(main_process)" "$process"

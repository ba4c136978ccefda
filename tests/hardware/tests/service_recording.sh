#!/usr/bin/env bash
# A button begins and ends a recording, and a light tells; a full disk ends the recording alone.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu gpio_sim

readonly folder=/var/lib/gimbald/recordings
is_recording() { [[ $(status_of .recording.is_recording) == true ]]; }
is_not_recording() { ! is_recording; }
recorded() { (($(status_of .recording.frames) >= $1)); }
press() { pull 2 down; sleep 0.5; pull 2 up; }
unmount() { umount "$folder"; }  # which the service must have left

pull 2 up
start_service <<TOML
outputs = ["identity ! fakesink"]
$camera_and_imu
[recording]
folder = "$folder"
min_free_mb = 0
[gpio]
record_button = "$gpio_chip:2"
record_button_active_low = true
status_led = "$gpio_chip:3"
TOML
wait_until "10 pictures are shown" have_shown 10

press
wait_until "a recording is made" is_recording
wait_until "5 frames are recorded" recorded 5
expect_equal "light" "$(level 3)" 1
recording=$(status_of .recording.folder)
press
wait_until "the recording has ended" is_not_recording
wait_until "the light is off" test "$(level 3)" = 0
gimbalctl sessions show "$recording" || fail "the recording cannot be read"

mount -t tmpfs -o size=256k,uid=gimbald,gid=gimbald tmpfs "$folder"
unplugging+=(unmount)
gimbalctl record start
wait_until "the full disk is said" is_degraded recording-failed
status_of .recording.failure | grep -i 'space' || fail "it is not said why: $(status_of .recording.failure)"
expect_pictures_go_on
for full in "$folder"/*/; do gimbalctl sessions show "$full" || fail "what was recorded cannot be read"; done
systemctl stop gimbald
expect_equal "end" "$(service_property Result)" success

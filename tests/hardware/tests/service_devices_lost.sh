#!/usr/bin/env bash
# Camera and IMU go away and come back; the stream goes on, and what is missing is said.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

readonly driver=/sys/bus/platform/drivers/vivid

start_usual_service

echo vivid.0 >"$driver/unbind"
wait_until "the loss of the camera is said" is_degraded no-camera
expect_pictures_go_on
echo vivid.0 >"$driver/bind"
wait_until "the camera is back" is_not_degraded no-camera
expect_pictures_go_on

unplug_recorded_imu
wait_until "the loss of the IMU is said" is_degraded no-imu
expect_pictures_go_on
plug_recorded_imu
wait_until "the IMU is back" is_not_degraded no-imu
expect_pictures_go_on
expect_equal "process" "$(main_process)" "$process"

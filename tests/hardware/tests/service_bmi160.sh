#!/usr/bin/env bash
# An IMU of six axes with a driver of the kernel's: what it measures is the orientation that is said.
# limit: 600 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid i2c_stub bmi160

readonly one_g=16384  # steps, at 2 g

# is_held ELEVATION ROLL: within 2 degrees
is_held() {
  [[ $(status_of ".orientation.degrees | ((.elevation - $1) | fabs) < 2 and ((.roll - $2) | fabs) < 2") == true ]]
}

# expect_held ELEVATION ROLL: by a service that begins so
expect_held() {
  systemctl restart gimbald
  wait_until "the camera is held at $1 and $2 degrees" is_held "$1" "$2"
}

# The camera's y is down.
set_bmi160_axes 0 0 0 0 $((-one_g)) 0
start_service <<TOML
outputs = ["identity ! fakesink"]
${camera_and_imu/gyro_3d/bmi160}
TOML
wait_until "10 pictures are shown" have_shown 10
wait_until "the camera stands upright" is_held 0 0
set_bmi160_axes 0 0 0 0 $((-one_g * 866 / 1000)) $((one_g / 2))
expect_held 30 0
set_bmi160_axes 0 0 0 $((-one_g / 2)) $((-one_g * 866 / 1000)) 0
expect_held 0 30
expect_equal "what does not work" "$(degraded)" ""

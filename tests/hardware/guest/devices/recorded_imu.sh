# shellcheck shell=bash
# An IMU: a hand's recorded motion, over and over, by way of /dev/uhid and the kernel's HID sensor hub
# to two IIO devices, stamped by the kernel. Before each time it lies still for recorded_imu_rest_s seconds,
# 0 unless a test says so. Sets gyro_device and accel_device (folders in sysfs), and recorded_imu_passes: a
# file with when each time began, in ns on CLOCK_MONOTONIC.

plug_recorded_imu() {
  modprobe -a uhid hid-sensor-hub hid-sensor-gyro-3d hid-sensor-accel-3d
  recorded_imu_passes=$scratch/passes
  "$programs/recorded_imu" "$motion" "${recorded_imu_rest_s:-0}" >"$recorded_imu_passes" &
  recorded_imu=$!
  wait_until "gyro_3d is there" iio_device_named gyro_3d
  wait_until "accel_3d is there" iio_device_named accel_3d
  gyro_device=$(iio_device_named gyro_3d)
  accel_device=$(iio_device_named accel_3d)
}

# Its own clock stamps from now, five seconds ahead; or the kernel again.
change_clock_of_recorded_imu() { kill -USR1 "$recorded_imu"; }

unplug_recorded_imu() {
  kill "$recorded_imu" 2>/dev/null || true
  wait "$recorded_imu" || true
}

# The folder in sysfs of the IIO device with this name; fails if there is none.
iio_device_named() {
  local name
  name=$(grep -lx "$1" /sys/bus/iio/devices/iio:device*/name) && dirname "$name"
}

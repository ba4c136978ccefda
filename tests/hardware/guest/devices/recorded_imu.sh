# shellcheck shell=bash
# An IMU: a hand's recorded motion, over and over, by way of /dev/uhid and the kernel's HID sensor hub
# to two IIO devices, stamped by the kernel. Sets gyro_device and accel_device (folders in sysfs).

plug_recorded_imu() {
  modprobe -a uhid hid-sensor-hub hid-sensor-gyro-3d hid-sensor-accel-3d
  "$programs/recorded_imu" "$motion" &
  recorded_imu=$!
  wait_until "gyro_3d is there" iio_device_named gyro_3d
  wait_until "accel_3d is there" iio_device_named accel_3d
  gyro_device=$(iio_device_named gyro_3d)
  accel_device=$(iio_device_named accel_3d)
}

unplug_recorded_imu() {
  kill "$recorded_imu" 2>/dev/null || true
  wait "$recorded_imu" || true
}

# The folder in sysfs of the IIO device with this name; fails if there is none.
iio_device_named() {
  local name
  name=$(grep -lx "$1" /sys/bus/iio/devices/iio:device*/name) && dirname "$name"
}

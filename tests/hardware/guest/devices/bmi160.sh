# shellcheck shell=bash
# A 6-axis IMU with a driver of the kernel's: Bosch's BMI160 whose registers are i2c-stub's, sampled by
# a timer. Needs i2c_stub. Sets bmi160_device and bmi160_timer (folders in sysfs).

readonly bmi160_address=0x69 bmi160_trigger=/sys/kernel/config/iio/triggers/hrtimer/bmi160
readonly bmi160_chip_id=0xd1 bmi160_data=0x0c  # gyro x, y, z, then accel x, y, z, little-endian

plug_bmi160() {
  load -a industrialio-triggered-buffer iio-trig-hrtimer bmi160_i2c
  set_registers "$bmi160_address" 0x00 "$bmi160_chip_id"
  # As after a reset: 100 Hz and 2 g, 100 Hz and 2000 deg/s (data sheet BST-BMI160-DS000, ACC_CONF ff.).
  set_registers "$bmi160_address" 0x40 0x28 0x03 0x28 0x00
  echo "bmi160 $bmi160_address" >"/sys/bus/i2c/devices/i2c-$i2c_bus/new_device"
  wait_until "the driver has taken the BMI160" bmi160_folder
  bmi160_device=$(bmi160_folder)
  mkdir "$bmi160_trigger"
  bmi160_timer=$(dirname "$(grep -lx bmi160 /sys/bus/iio/devices/trigger*/name)")
  echo bmi160 >"$bmi160_device/trigger/current_trigger"
}

unplug_bmi160() {
  echo >"$bmi160_device/trigger/current_trigger"
  rmdir "$bmi160_trigger"
  echo "$bmi160_address" >"/sys/bus/i2c/devices/i2c-$i2c_bus/delete_device"
}

bmi160_folder() {
  local name
  name=$(grep -lx bmi160 /sys/bus/iio/devices/iio:device*/name) && dirname "$name"
}

# set_bmi160_axes GYRO_X GYRO_Y GYRO_Z ACCEL_X ACCEL_Y ACCEL_Z, in the chip's steps
set_bmi160_axes() {
  local axis bytes=()
  for axis in "$@"; do bytes+=($((axis & 0xff)) $(((axis >> 8) & 0xff))); done
  set_registers "$bmi160_address" "$bmi160_data" "${bytes[@]}"
}

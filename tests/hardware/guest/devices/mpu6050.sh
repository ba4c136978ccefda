# shellcheck shell=bash
# A 6-axis IMU that no driver of the kernel's has: the registers of an MPU-6050 as i2c-stub keeps them.
# Its FIFO always holds one sample, which has no time of its own; so it shows how a chip is found, set
# up and read, and nothing of rates. Needs i2c_stub. Sets mpu6050_bus.

readonly mpu6050_address=0x68

plug_mpu6050() {
  mpu6050_bus=/dev/i2c-$i2c_bus
  set_registers "$mpu6050_address" 0x72 0 12           # FIFO_COUNT: accelerometer and gyroscope
  set_registers "$mpu6050_address" 0x74 8 0x68 0 0 0 0 0 1 0 2 0 3  # FIFO_R_W; the second is WHO_AM_I as well
}

unplug_mpu6050() { :; }

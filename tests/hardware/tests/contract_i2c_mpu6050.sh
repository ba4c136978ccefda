#!/usr/bin/env bash
# The user-space driver of the MPU-6050 on a bus that knows SMBus alone.
source /hardware/guest/test.sh
needs i2c_stub mpu6050

# A FIFO that is never empty says nothing of when its samples were taken.
expect_contract imu_contract_test 'Mpu6500-*Stamps*' \
  GIMBALD_TEST_I2C_MPU="$mpu6050_bus:$mpu6050_address"

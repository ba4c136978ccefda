#!/usr/bin/env bash
# The IIO driver on a gyroscope and an accelerometer that are two devices.
source /hardware/guest/test.sh
needs recorded_imu

expect_contract imu_contract_test Iio GIMBALD_TEST_IIO=gyro_3d

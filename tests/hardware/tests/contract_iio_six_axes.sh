#!/usr/bin/env bash
# The IIO driver on one device with both sensors, sampled by a timer.
source /hardware/guest/test.sh
needs i2c_stub bmi160

set_bmi160_axes 1 2 3 4 5 16384
expect_contract imu_contract_test Iio GIMBALD_TEST_IIO=bmi160

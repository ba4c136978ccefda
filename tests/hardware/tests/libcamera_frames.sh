#!/usr/bin/env bash
# The libcamera driver on vimc, which is slow where it is emulated.
# limit: 900 s
source /hardware/guest/test.sh
needs vimc

camera=$(gimbalctl devices | grep -o 'platform/vimc[^ ]* Sensor [AB]' | head -n 1)
# With RGB888 libcamera gives the last link two formats that the kernel holds for different ones.
expect_contract camera_contract_test Libcamera \
  GIMBALD_TEST_LIBCAMERA="$camera" GIMBALD_TEST_LIBCAMERA_FORMAT=BGR888

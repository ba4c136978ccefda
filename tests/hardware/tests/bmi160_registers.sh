#!/usr/bin/env bash
# The kernel's driver of a 6-axis IMU samples registers that change under it.
source /hardware/guest/test.sh
needs i2c_stub bmi160

readonly samples=400 sample_bytes=24  # six axes of 16 bits, 4 bytes of nothing, a stamp of 64 bits
readonly still="1 -2 3 100 -200 16384" turned="-4000 5000 -6000 7 -8 9"

echo monotonic >"$bmi160_device/current_timestamp_clock"
echo 50 >"$bmi160_timer/sampling_frequency"
# shellcheck disable=SC2086  # six numbers
set_bmi160_axes $still
iio_readdev -u local: -T 30000 -b 5 -s "$samples" bmi160 >"$scratch/raw" &
capture=$!
wait_until "the first samples are there" test -s "$scratch/raw"
# shellcheck disable=SC2086
set_bmi160_axes $turned
wait "$capture"

expect_equal "bytes" "$(stat -c %s "$scratch/raw")" "$((samples * sample_bytes))"
paste -d ' ' <(od -A n -v -w$sample_bytes -t d2 "$scratch/raw") <(od -A n -v -w$sample_bytes -t d8 "$scratch/raw") |
  tr -s ' ' | sed 's/^ //' >"$scratch/samples"
# Libiio puts channels in the order of their scan index, and the driver its accelerometer last.
cut -d ' ' -f 1-6 "$scratch/samples" | uniq >"$scratch/axes"
expect_equal "first sample" "$(head -n 1 "$scratch/axes")" "$still"
expect_equal "last sample" "$(tail -n 1 "$scratch/axes")" "$turned"
cut -d ' ' -f 15 "$scratch/samples" | expect_rising "stamp"

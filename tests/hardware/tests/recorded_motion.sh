#!/usr/bin/env bash
# Both devices of the recorded IMU give the recording's samples, in order, stamped on CLOCK_MONOTONIC.
source /hardware/guest/test.sh
readonly motion=/usr/share/gimbald/motions/iphone-handheld  # no two samples of it are alike
needs recorded_imu

readonly samples=300 sample_bytes=24  # three axes of 32 bits, 4 bytes of nothing, a stamp of 64 bits

# capture DEVICE'S_FOLDER FILE: "x y z stamp" of each sample, in rad/s or m/s², and ns
capture() {
  local name scale
  name=$(cat "$1/name")
  scale=$(cat "$1"/in_*_scale)
  echo monotonic >"$1/current_timestamp_clock"
  # The kernel holds half of them, lest a guest that is kept waiting loses any.
  iio_readdev -u local: -T 30000 -b $((samples / 2)) -s "$samples" "$name" >"$2.raw"
  expect_equal "bytes of $name" "$(stat -c %s "$2.raw")" "$((samples * sample_bytes))"
  paste -d ' ' <(od -A n -v -w$sample_bytes -t d4 "$2.raw") <(od -A n -v -w$sample_bytes -t d8 "$2.raw") |
    awk -v scale="$scale" '{ printf "%.7f %.7f %.7f %s\n", $1 * scale, $2 * scale, $3 * scale, $9 }' >"$2"
}

# expect_recorded CAPTURE CSV SIGN STEP: to within a step, the samples are rows of the CSV, none twice and
# none before another; the recording may have begun again. A guest that is kept waiting may miss a few.
expect_recorded() {
  awk -v sign="$3" -v step="$4" '
    BEGIN { rows = 0; at = -1; missed = 0; most_missed = 20 }
    function near(a, b) { return a - b <= step && b - a <= step }
    function is_row(row) { return near(x[row], $1) && near(y[row], $2) && near(z[row], $3) }
    function complain(text) { printf "sample %d: %s\n", FNR, text; failed = 1; exit 1 }
    FNR == NR {
      if (FNR == 1) next
      split($0, field, ",")
      x[rows] = sign * field[2]; y[rows] = sign * field[3]; z[rows] = sign * field[4]
      rows++
      next
    }
    FNR == 1 {
      for (at = 0; at < rows && !is_row(at); at++) {}
      if (at == rows) complain("is not in the recording")
      next
    }
    {
      for (ahead = 1; ahead <= most_missed + 1 && !is_row((at + ahead) % rows); ahead++) {}
      if (ahead > most_missed + 1) {
        while (ahead < rows && !is_row((at + ahead) % rows)) ahead++
        complain(sprintf("is %d rows after the one before", ahead))
      }
      at = (at + ahead) % rows
      missed += ahead - 1
    }
    END { if (!failed) printf "%d samples missed\n", missed
          exit failed || missed > most_missed }' "$2" "$1"
}

capture "$gyro_device" "$scratch/gyro" &
gyro_capture=$!
capture "$accel_device" "$scratch/accel"
wait "$gyro_capture"

expect_recorded "$scratch/gyro" "$motion/gyro.csv" 1 1e-6
expect_recorded "$scratch/accel" "$motion/accel.csv" -1 1e-5  # the file has gravity's sign
for log in gyro accel; do
  cut -d ' ' -f 4 "$scratch/$log" | expect_rising "stamp of $log"
done
# Nothing has suspended this guest, so its clocks agree.
uptime_s=$(cut -d. -f1 /proc/uptime)
last_stamp_s=$(($(tail -n 1 "$scratch/gyro" | cut -d ' ' -f 4) / 1000000000))
((last_stamp_s <= uptime_s && last_stamp_s > uptime_s - 60)) ||
  fail "the last stamp is $last_stamp_s s on a clock that says $uptime_s s"

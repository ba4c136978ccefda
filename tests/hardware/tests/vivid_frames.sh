#!/usr/bin/env bash
# The camera that the other tests see: each frame once, in order, on CLOCK_MONOTONIC, whole.
source /hardware/guest/test.sh
needs vivid

readonly frames=50 frame_bytes=$((640 * 360 * 3 / 2))

v4l2-ctl -d "$vivid_node" --verbose --stream-mmap --stream-count="$frames" >"$scratch/log" 2>&1
# cap dqbuf: 3 seq:      7 bytesused: 345600 ts: 27.160141 delta: 40.000 ms (ts-monotonic, ts-src-eof)
grep 'cap dqbuf' "$scratch/log" >"$scratch/frames" || fail "no frames: $(tail -n 2 "$scratch/log")"

expect_equal "number of frames" "$(wc -l <"$scratch/frames")" "$frames"
expect_equal "frames of a whole picture" \
  "$(grep -c "bytesused: $frame_bytes " "$scratch/frames")" "$frames"
expect_equal "frames stamped on CLOCK_MONOTONIC at their end" \
  "$(grep -c 'ts-monotonic, ts-src-eof' "$scratch/frames")" "$frames"
sed 's/.* seq: *\([0-9]*\).*/\1/' "$scratch/frames" | expect_rising "sequence"
sed 's/.* ts: *\([0-9.]*\).*/\1/' "$scratch/frames" | expect_rising "stamp"

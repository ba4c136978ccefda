# shellcheck shell=bash
# gimbald as a test runs it: y4m through a pipe into a file, and what it says into another.

daemon_pictures=$scratch/pictures.y4m
daemon_log=$scratch/gimbald.log

# start_gimbald WIDTH HEIGHT: with the configuration on standard input
start_gimbald() {
  frame_bytes=$(($1 * $2 * 3 / 2 + 6))  # and "FRAME\n"
  cat >"$scratch/gimbald.toml"
  mkfifo "$scratch/pipe"
  cat "$scratch/pipe" >"$daemon_pictures" &
  daemon_reader=$!
  gimbald --config "$scratch/gimbald.toml" >"$scratch/pipe" 2>"$daemon_log" &
  daemon=$!
}

# Waits for the end, and says what it said; what it ended with is left in daemon_status.
finish_gimbald() {
  daemon_status=0
  wait "$daemon" || daemon_status=$?
  wait "$daemon_reader"
  cat "$daemon_log"
}

# The number that stands before some words in gimbald's last lines, such as 200 in "200 frames in, ".
count_of() { sed -n "s/.*[^0-9]\([0-9]\+\) $1.*/\1/p" "$daemon_log" | tail -n 1; }

# What came in came out or was counted as dropped; and what is said to be written is in the pipe, whole.
expect_all_accounted_for() {
  local dropped bytes header_bytes
  dropped=$(($(count_of 'dropped for want of orientation') + $(count_of 'before drawing')))
  expect_equal "frames out or dropped" $(($(count_of 'out,') + dropped)) "$(count_of 'frames in')"
  bytes=$(stat -c %s "$daemon_pictures")
  header_bytes=$(head -n 1 "$daemon_pictures" | wc -c)
  expect_equal "bytes after the header" $((bytes - header_bytes)) \
    $(($(count_of 'frames written') * frame_bytes))
}

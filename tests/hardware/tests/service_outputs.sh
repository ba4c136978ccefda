#!/usr/bin/env bash
# Other programs get pictures, by shared memory and by a video node; one that goes away disturbs nobody.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu v4l2loopback

readonly picture_bytes=$((640 * 360 * 3 / 2))
has_failed() { [[ $(status_of ".outputs[$1].state") == failed ]]; }
read_pipe() { cat "$pipe" >"$scratch/$1" & }
has_bytes() { (($(stat -c %s "$scratch/$1") >= $2)); }

make_pipe
read_pipe before
reader=$!

start_service <<TOML
outputs = ["videoconvert ! video/x-raw,format=I420 ! filesink location=$pipe"]
$camera_and_imu
[[output]]
preset = "shm"
socket = "/run/gimbald/video"
[[output]]
preset = "v4l2loopback"
device = "$loopback_node"
TOML
for output in 0 1 2; do wait_until "output $output has begun" have_written "$output"; done

timeout 60 gst-launch-1.0 -q shmsrc socket-path=/run/gimbald/video is-live=true num-buffers=3 ! \
  filesink location="$scratch/shared" || fail "no pictures through shared memory"
expect_equal "bytes shared" "$(stat -c %s "$scratch/shared")" $((3 * picture_bytes))
timeout 60 v4l2-ctl -d "$loopback_node" --stream-mmap --stream-count=3 --stream-to="$scratch/looped" ||
  fail "no pictures through v4l2loopback"
expect_equal "bytes looped" "$(stat -c %s "$scratch/looped")" $((3 * 640 * 360 * 2))

wait_until "pictures are in the pipe" has_bytes before "$picture_bytes"
kill "$reader"
wait_until "the loss of the reader is said" has_failed 0
expect_equal "what does not work" "$(degraded)" output-failed
journalctl --no-pager -o cat -p err GIMBALD_PART=output --since "$since" | grep -F "$pipe" ||
  fail "the journal has it not as the output's"
looped=$(status_of '.outputs[2].written')
wait_until "the others go on" have_written 2 $((looped + 10))
read_pipe after
wait_until "pictures are in the pipe again" has_bytes after "$picture_bytes"
wait_until "all is well" is_not_degraded output-failed

systemctl stop gimbald
expect_equal "end" "$(service_property Result)" success
expect_all_accounted_for

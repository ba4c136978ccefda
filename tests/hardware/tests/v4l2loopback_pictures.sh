#!/usr/bin/env bash
# What one program writes to the loopback, another reads from it.
source /hardware/guest/test.sh
needs v4l2loopback

# Which it is only while somebody writes.
is_camera() { v4l2-ctl -d "$1" --info | grep -q 'Video Capture'; }

gst-launch-1.0 -q videotestsrc pattern=blue num-buffers=400 is-live=true ! \
  video/x-raw,format=YUY2,width=320,height=240,framerate=20/1 ! \
  v4l2sink device="$loopback_node" >"$scratch/writer" 2>&1 &
writer=$!
wait_until "the loopback is a camera" is_camera "$loopback_node"
v4l2-ctl -d "$loopback_node" --stream-mmap --stream-count=10 --stream-to="$scratch/pictures" >"$scratch/reader" 2>&1
kill "$writer"

expect_equal "bytes" "$(stat -c %s "$scratch/pictures")" $((10 * 320 * 240 * 2))

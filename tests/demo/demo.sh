#!/usr/bin/env bash
# The main job on ten seconds of video that anyone can make: a real hand's motion, a rolling shutter, a phone's sensors.
# Usage: demo.sh BUILD_FOLDER OUTPUT_FOLDER
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
build=$(readlink -f "$1")
mkdir -p "$2"
cd "$2"

gimbalctl="$build/daemon/gimbalctl/gimbalctl"
readonly start_s=0 duration_s=10

step() { echo; echo "== $*"; }

to_mp4() {
  local output=$1
  shift
  gst-launch-1.0 -q "$@" ! videoconvert ! x264enc speed-preset=veryfast pass=quant quantizer=22 ! \
    mp4mux ! filesink location="$output"
}

# One frame of a video as a picture for the plots; GStreamer counts pictures, it does not pick them.
frame_of() {
  local video=$1 index=$2 picture=$3 all
  all=$(mktemp -d)
  gst-launch-1.0 -q filesrc location="$video" ! decodebin ! videoconvert ! videoscale ! \
    video/x-raw,width=960,height=540 ! jpegenc quality=92 ! multifilesink location="$all/%d.jpg"
  cp "$all/$index.jpg" "$picture"
  rm -r "$all"
}

step "a phone's camera, shaken: $duration_s s of 1280x720, rolling shutter, noisy sensors"
rm -rf session
"$gimbalctl" simulate -o session --motion iphone --start "$start_s" --duration "$duration_s"

step "steady: rectified row by row, and stabilized"
"$gimbalctl" stabilize session -o stabilized.mp4 --path-log path.csv --report report.json
"$gimbalctl" stabilize session -o rectified.mp4 --rectify-only
"$gimbalctl" orient session -o orientation.csv

step "side by side"
to_mp4 original.mp4 filesrc location=session/video.mkv ! decodebin
half_size="videoscale ! video/x-raw,width=960,height=540"
# shellcheck disable=SC2086 # words of a pipeline
to_mp4 side-by-side.mp4 \
  filesrc location=original.mp4 ! decodebin ! $half_size ! both.sink_0 \
  filesrc location=stabilized.mp4 ! decodebin ! $half_size ! both.sink_1 \
  compositor name=both sink_1::xpos=960 ! video/x-raw,width=1920,height=540

step "judged against the truth"
"$build/tests/demo/truth_judge" session orientation.csv path.csv . | tee improved.txt

index=$(cat most_bent_frame.txt)
frame_of original.mp4 "$index" before.jpg
frame_of stabilized.mp4 "$index" after.jpg
gnuplot -e "frame=$index" "$here/demo.gnuplot"

step "compared by pictures alone, short and small: ./dev bench compares more"
python3 -B "$here/../compare/compare.py" "$build" compare --sessions walk pan --size 640x360 --duration 5 \
  --stabilizers raw vidstab adaptive-hann gimbalctl gimbalctl-fill

step "look at it"
printf '%s\n' "$PWD"/{original,rectified,stabilized,side-by-side}.mp4 "$PWD/demo.png" "$PWD/compare/index.html"

#!/usr/bin/env bash
# The media device that libcamera will take as a camera delivers pictures.
source /hardware/guest/test.sh
needs vimc

set_format() { media-ctl -d "$vimc_media" --set-v4l2 "\"$1\":$2[fmt:$3/640x480]"; }

set_format "Sensor A" 0 SRGGB8_1X8
set_format "Debayer A" 0 SRGGB8_1X8
set_format "Scaler" 0 RGB888_1X24
set_format "Scaler" 1 RGB888_1X24
# The sensor's other branch is checked with the one that is used.
raw_node=$(media-ctl -d "$vimc_media" --entity "Raw Capture 0")
v4l2-ctl -d "$raw_node" --set-fmt-video=width=640,height=480,pixelformat=RGGB >/dev/null
node=$(media-ctl -d "$vimc_media" --entity "RGB/YUV Capture")
v4l2-ctl -d "$node" --set-fmt-video=width=640,height=480,pixelformat=RGB3 >/dev/null
v4l2-ctl -d "$node" --verbose --stream-mmap --stream-count=3 \
  >"$scratch/log" 2>&1 || fail "$(tail -n 2 "$scratch/log")"
expect_equal "number of frames" "$(grep -c 'cap dqbuf' "$scratch/log")" 3

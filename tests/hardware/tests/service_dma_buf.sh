#!/usr/bin/env bash
# A camera's pictures are drawn from where the kernel's driver put them, into memory that encoders can take
# over: none is copied. The service may do that from behind what shuts it in.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

watchdog_s=300
start_service <<TOML
outputs = ["videoconvert ! video/x-raw,format=I420 ! fakesink"]
${camera_and_imu/warper = \"cpu\"/warper = \"gles\"}
dma_buf = "always"
TOML
wait_until "5 pictures are drawn" have_shown 5
expect_equal "ways of the pictures" "$(status_of .transfers)" "in dma-buf R8+GR88, out dma-buf R8+GR88"

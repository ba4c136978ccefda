#!/usr/bin/env bash
# The V4L2 driver on a camera of the kernel's.
source /hardware/guest/test.sh
needs vivid

expect_contract camera_contract_test V4l2 GIMBALD_TEST_V4L2="$vivid_node"

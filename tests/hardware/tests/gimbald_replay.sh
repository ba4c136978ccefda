#!/usr/bin/env bash
# The daemon on a recording at its own pace, to its end.
source /hardware/guest/test.sh
source /hardware/guest/daemon.sh

start_gimbald 320 180 <<TOML
outputs = ["-"]
[camera]
driver = "replay"
[imu]
driver = "replay"
[replay]
session = "$session"
repeat = false
[stabilization]
warper = "cpu"
TOML
finish_gimbald

expect_equal "exit status" "$daemon_status" 0
expect_equal "frames in" "$(count_of 'frames in')" $(($(wc -l <"$session/frames.csv") - 1))
expect_at_least "frames out" "$(count_of 'out,')" 1
expect_all_accounted_for

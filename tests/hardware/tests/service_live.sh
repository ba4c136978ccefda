#!/usr/bin/env bash
# From the package: a camera and an IMU of the kernel's, used by a user who may use nothing else; pictures
# by a pipe and by RTSP.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

make_pipe
head -c $((30 * 640 * 360 * 3 / 2)) "$pipe" >"$scratch/piped.mkv" &
pipe_reader=$!

start_service <<TOML
outputs = ["videoconvert ! video/x-raw,format=I420 ! matroskamux streamable=true ! filesink location=$pipe"]
$camera_and_imu
[[output]]
preset = "rtsp"
TOML
expect_equal "state" "$(service_property ActiveState)" active

# As little as can be, and all of it in force.
process=/proc/$(main_process)/status
expect_equal "user" "$(stat -c %U "/proc/$(main_process)")" gimbald
expect_equal "capabilities" "$(sed -n 's/CapBnd:\t*0*//p' "$process")" ""
expect_equal "new privileges are refused" "$(sed -n 's/NoNewPrivs:\t//p' "$process")" 1
expect_equal "system calls are filtered" "$(sed -n 's/Seccomp:\t//p' "$process")" 2
expect_equal "control socket" "$(stat -c '%U:%G %a' /run/gimbald/control.sock)" "gimbald:gimbald 660"

wait_until "pictures go by RTSP" have_written 1
# By the stamps of the server alone: a client that makes up for the jitter of the network sets some alike.
stamps_of rtspsrc location=rtsp://127.0.0.1:8554/gimbald latency=0 buffer-mode=none ! rtph264depay >"$scratch/streamed"
wait "$pipe_reader"
stamps_of filesrc location="$scratch/piped.mkv" ! matroskademux >"$scratch/piped"
wait_until "it has seen that nobody reads the pipe any more" is_degraded output-failed
expect_equal "what does not work" "$(degraded)" output-failed
expect_at_least "samples" "$(status_of .imu.samples)" 100
for way in piped streamed; do
  expect_equal "pictures $way" "$(wc -l <"$scratch/$way")" 20
  expect_rising "stamp $way" <"$scratch/$way"
done

systemctl stop gimbald
expect_equal "end" "$(service_property Result)" success
expect_all_accounted_for

#!/usr/bin/env bash
# Killed, and hung, it is started again; what was being recorded can be read.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid recorded_imu

have_recorded() { (($(status_of .recording.frames) >= $1)); }

watchdog_s=20
start_usual_service

gimbalctl record start
wait_until "5 frames are recorded" have_recorded 5
recording=$(status_of .recording.folder)
kill -KILL "$(main_process)"
wait_until "it runs again" has_started_again 1
wait_until "pictures are shown again" have_shown 10
gimbalctl sessions show "$recording" || fail "the recording cannot be read"

kill -STOP "$(main_process)"
wait_until "the watchdog has found it" has_said 'Watchdog timeout'
wait_until "it runs again" has_started_again 2
wait_until "pictures are shown again" have_shown 10

# The thread that draws alone: all others go on, and no picture comes.
drawing_thread() { grep -lx draw "/proc/$(main_process)/task/"*/comm | cut -d / -f 5; }
"$programs/hold_thread" "$(drawing_thread)" &
holding=$!
wait_until "the watchdog has found it too" has_started_again 3
kill "$holding" 2>/dev/null || true
wait_until "pictures are shown once more" have_shown 10

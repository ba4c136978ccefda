#!/usr/bin/env bash
# The orientation that the daemon says it has is that of the recorded motion.
# limit: 900 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
readonly recorded_imu_rest_s=10
needs vivid recorded_imu

readonly most_deg=2 readings=12
readings_are_due() { (($(wc -l <"$recorded_imu_passes") > passes)); }

start_usual_service

passes=$(wc -l <"$recorded_imu_passes")
wait_until "the recording begins again" readings_are_due
begin_ns=$(tail -n 1 "$recorded_imu_passes")
for ((reading = 0; reading < readings; ++reading)); do
  status_of '.orientation | [.t_s, .q_world_imu[]] | map(tostring) | join(" ")'
  sleep 1
done >"$scratch/said"

first_stamp_s=$(sed -n '2s/,.*//p' "$motion/gyro.csv")
awk -F '[ ,]' -v begin_ns="$begin_ns" -v first_s="$first_stamp_s" -v most_deg="$most_deg" \
  -f /hardware/guest/compare_orientations.awk "$motion/truth.csv" "$scratch/said"

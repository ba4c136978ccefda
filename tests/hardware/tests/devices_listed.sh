#!/usr/bin/env bash
# What is there is listed, and why somebody cannot use it.
source /hardware/guest/test.sh
needs vivid i2c_stub bmi160 gpio_sim

# expect_said AS WHAT..: in what AS was told
expect_said() {
  local told=$1 what
  shift
  for what in "$@"; do grep -qF "$what" "$scratch/$told" || { cat "$scratch/$told"; fail "$told is not told: $what"; }; done
}

gimbalctl devices >"$scratch/root"
expect_said root "$vivid_node" bmi160 "$gpio_chip"
! grep -q 'permission' "$scratch/root" || fail "root is told of permissions"

runuser -u nobody -- gimbalctl devices >"$scratch/nobody"
expect_said nobody "$vivid_node" "group video" "group iio" "group gpio"

chmod 755 "$scratch"
cat >"$scratch/gimbald.toml" <<TOML
outputs = ["identity ! fakesink"]
[camera]
driver = "v4l2"
horizontal_fov_deg = 60
[v4l2]
device = "$vivid_node"
[imu]
driver = "iio"
TOML
! runuser -u nobody -g iio -- gimbald --config "$scratch/gimbald.toml" >"$scratch/refusal" 2>&1 ||
  fail "it runs without permission"
expect_said refusal "$vivid_node" "group video"
expect_equal "lines" "$(wc -l <"$scratch/refusal")" 1

# shellcheck shell=bash
# What every test begins with: source it, name the devices it needs, then say what must be.
set -euo pipefail

programs=/usr/libexec/gimbald-tests
session=$programs/session  # 8 s of 320x180 at 25 frames/s
motion=$programs/motion    # 30 s of a hand's motion at 100 Hz, without noise; truth.csv has its orientation
scratch=$(mktemp -d)
unplugging=()

fail() {
  echo "$*"
  exit 1
}

# For what this guest or this build lacks.
skip() {
  echo "skipped: $*"
  exit 77
}

# needs DEVICE..: plugs in what devices/DEVICE.sh describes, and out again when the test ends. What a
# device sets for the test (its node, its bus) is said at the head of its file.
needs() {
  local device
  for device in "$@"; do
    source "/hardware/guest/devices/$device.sh"
    unplugging=("unplug_$device" "${unplugging[@]}")
    "plug_$device"
  done
}

tidy_up() {
  local unplug
  for unplug in "${unplugging[@]}"; do "$unplug" || echo "$unplug failed"; done
  rm -rf "$scratch"
}
trap tidy_up EXIT

# load MODULE [PARAMETER..]: and waits until udev has named what came of it.
load() {
  modprobe "$@"
  udevadm settle
}

# Emulated, a second of work may take several: what waits takes plenty, what is there does not wait.
# wait_until WHAT COMMAND..
wait_until() {
  local what=$1 end=$((SECONDS + 180))
  shift
  until "$@" >/dev/null 2>&1; do
    ((SECONDS < end)) || fail "waited three minutes in vain until $what"
    sleep 0.1
  done
}

expect_equal() {
  local what=$1 found=$2 expected=$3
  [[ $found == "$expected" ]] || fail "$what is $found, not $expected"
}

expect_at_least() {
  local what=$1 found=$2 least=$3
  ((found >= least)) || fail "$what is $found, less than $least"
}

# Numbers on standard input, one a line, each larger than the one before.
expect_rising() {
  local what=$1
  awk -v what="$what" '
    NR > 1 && $1 <= last { printf "%s: %s comes after %s\n", what, $1, last; exit 1 }
    { last = $1 }
    END { if (NR < 2) { printf "%s: only %d numbers\n", what, NR; exit 1 } }'
}

# expect_contract PROGRAM NAME VARIABLE=VALUE..: the driver NAME keeps what every driver promises, on the
# device that the environment gives it. NAME-PATTERN leaves out the tests of that pattern. Tests that were
# all skipped would show nothing.
expect_contract() {
  local program=$1 driver=$2
  shift 2
  env "$@" "$programs/$program" --gtest_brief=1 --gtest_filter="*/$driver" 2>&1 | tee "$scratch/contract"
  ((PIPESTATUS[0] == 0)) || fail "$driver does not keep the contract"
  local passed
  passed=$(sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' "$scratch/contract")
  expect_at_least "tests passed by $driver" "${passed:-0}" 3
}

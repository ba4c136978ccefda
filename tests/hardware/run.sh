#!/usr/bin/env bash
# Runs the tests in tests/ against the kernel's virtual devices in a virtual machine; see README.md.
# Usage: run.sh "PACKAGE.." [TEST..]     the packages are those that gimbald is built with
# GIMBALD_RIG names the folder for what is generated, build/hardware unless told.
# Exit status: 0 all passed; 1 some did not, or the guest could not be made; 77 this machine lacks what
# is needed.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/host/rig.sh"

readonly boot_limit_s=1500
readonly status_guest_died=125

results=$rig/results

# --- making what is not there -----------------------------------------------------------------

require_tools() {
  [[ $(uname -m) == x86_64 ]] || skip "the virtual machine is for x86_64 so far"
  require_tree_tools qemu-system-x86_64 mke2fs
}

make_trees() {
  local guest_packages toolchain_packages
  guest_packages=$(words_of "$hardware/guest/packages.txt")
  toolchain_packages="make ccache xz-utils linux-headers-amd64 linux-source $1"
  trees=$(cached trees \
    "$(key_of "@$hardware/host/debian_tree.sh" "@$hardware/host/build_trees.sh" \
      "$guest_packages" "$toolchain_packages")" \
    "$hardware/host/build_trees.sh" "$guest_packages" "$toolchain_packages") ||
    skip "no Debian tree could be made; is the archive in reach?"
}

make_image() {
  local kernel modules
  kernel=$(basename "$trees"/guest/usr/lib/modules/*)
  modules=$(cached modules "$(key_of "@$hardware/host/build_modules.sh" "$trees")" \
    "$hardware/host/build_modules.sh" "$trees/toolchain" "$kernel")
  image=$(cached image \
    "$(key_of "@$hardware/host/build_image.sh" "$(cat "$hardware"/guest/system/*)" "$modules")" \
    "$hardware/host/build_image.sh" "$trees/guest" "$modules")
}

make_program() {
  local start=$SECONDS
  mkdir -p "$rig/ccache"
  "$BASH" "$hardware/host/build_program.sh" "$rig/program" "$trees/toolchain" "$rig/ccache" \
    >"$rig/program.log" 2>&1 || {
    tail -n 20 "$rig/program.log" >&2
    die "gimbald does not build on Debian 13; all of it is in $rig/program.log"
  }
  say "gimbald built in $((SECONDS - start)) s"
}

# --- running the tests ------------------------------------------------------------------------

all_tests() {
  local test
  for test in "$hardware"/tests/*.sh; do basename "$test" .sh; done
}

require_known() {
  local test
  for test in "$@"; do
    [[ -f $hardware/tests/$test.sh ]] || die "no test $test; there are: $(all_tests | xargs)"
  done
}

without_status() {
  local test
  for test in "$@"; do [[ -e $results/$test.status ]] || echo "$test"; done
}

# Boots the guest for these tests; however that ends, keeps what it left.
boot_for() {
  local exchange=$rig/exchange
  rm -rf "$exchange"
  mkdir -p "$exchange"
  "$BASH" "$hardware/host/run_in_guest.sh" -t "$boot_limit_s" "$image" "$rig/program" "$exchange" \
    "bash /hardware/guest/run_tests.sh /exchange/results $*" || boot_status=$?
  cp -f "$exchange/console.log" "$results/"
  cp -rf "$exchange/results/." "$results/" 2>/dev/null || true
}

# A guest that dies while it runs a test is charged to that test, and the others go on in a new one. A
# guest that dies before its first test is booted again, once.
run_tests() {
  local pending=("$@") boot_status retried=
  while ((${#pending[@]})); do
    boot_status=0
    boot_for "${pending[@]}"
    mapfile -t pending < <(without_status "${pending[@]}")
    ((${#pending[@]})) || break
    if [[ -e $results/${pending[0]}.log ]]; then
      echo "  ${pending[0]}: the guest ended with status $boot_status"
      echo "$status_guest_died" >"$results/${pending[0]}.status"
      pending=("${pending[@]:1}")
    elif [[ -z $retried ]]; then
      retried=yes
      say "the guest ended with status $boot_status before its first test: booting it once more"
      cp "$results/console.log" "$results/console.first.log"
    else
      tail -n 20 "$results/console.log" >&2
      die "the guest does not get to its first test"
    fi
  done
}

# On a busy host an emulated guest stands still now and then, for longer than a test has patience: what
# failed is run once more, in a guest of its own, and what it said the first time is kept.
run_failed_again() {
  local failed test
  mapfile -t failed < <(tests_with_verdict failed "$@")
  ((${#failed[@]})) || return 0
  say "once more: ${failed[*]}"
  for test in "${failed[@]}"; do
    mv "$results/$test.log" "$results/$test.first.log"
    rm "$results/$test.status"
  done
  run_tests "${failed[@]}"
}

tests_with_verdict() {
  local wanted=$1 test
  shift
  for test in "$@"; do
    if [[ $(verdict_of "$test") == "$wanted" ]]; then echo "$test"; fi
  done
}

verdict_of() {
  case $(cat "$results/$1.status") in
    0) echo passed ;;
    77) echo skipped ;;
    *) echo failed ;;
  esac
}

# As ctest ends, so that what reads the one can read the other.
summarize() {
  local failed skipped ran
  mapfile -t failed < <(tests_with_verdict failed "$@")
  mapfile -t skipped < <(tests_with_verdict skipped "$@")
  ran=$(($# - ${#skipped[@]}))
  echo
  ((${#skipped[@]} == 0)) || echo "did not run: ${skipped[*]}"
  ((${#failed[@]} == 0)) || echo "failed: ${failed[*]} (logs in $results)"
  echo "$((ran ? 100 * (ran - ${#failed[@]}) / ran : 0))% tests passed," \
    "${#failed[@]} tests failed out of $ran, in $SECONDS s"
  ((${#failed[@]} == 0))
}

main() {
  local packages=$1
  shift
  local tests=("$@")
  (($#)) || mapfile -t tests < <(all_tests)
  require_known "${tests[@]}"
  require_tools
  lock_kept
  make_trees "$packages"
  make_image
  make_program
  rm -rf "$results"
  mkdir "$results"
  run_tests "${tests[@]}"
  run_failed_again "${tests[@]}"
  summarize "${tests[@]}"
}

main "$@"

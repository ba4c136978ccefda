#!/usr/bin/env bash
# In the guest: installs what is to be tested, then runs each test by itself.
# Usage: run_tests.sh RESULTS TEST..
# Leaves RESULTS/TEST.{log,seconds,status}: what it printed, how long it took, how it ended (77 for
# skipped, 124 for too long). A test without a status was running when the guest died.
set -euo pipefail
tests=/hardware/tests

readonly usual_limit_s=120

# The package installs only where all is that it depends on.
install_program() {
  dpkg --install /program/*.deb
  cp -a /program/usr/. /usr/
}

# A test that needs longer says so: "# limit: 300 s".
limit_of() {
  local limit
  limit=$(sed -n 's/^# limit: \([0-9]*\) s$/\1/p' "$tests/$1.sh")
  echo "${limit:-$usual_limit_s}"
}

run_test() {
  local name=$1 start=$SECONDS status=0
  : >"$results/$name.log"
  timeout --kill-after=10 "$(limit_of "$name")" bash "$tests/$name.sh" >"$results/$name.log" 2>&1 || status=$?
  echo "$((SECONDS - start))" >"$results/$name.seconds"
  echo "$status" >"$results/$name.status"
}

verdict() {
  case $(cat "$results/$1.status") in
    0) echo "Passed" ;;
    77) echo "***Skipped" ;;
    124 | 137) echo "***Timeout" ;;
    *) echo "***Failed" ;;
  esac
}

results=$1
shift
mkdir -p "$results"
install_program
for name in "$@"; do
  run_test "$name"
  printf '  %-36s %-11s %4d s\n' "$name" "$(verdict "$name")" "$(cat "$results/$name.seconds")"
  [[ $(verdict "$name") == Passed ]] || tail -n 8 "$results/$name.log" | sed 's/^/      /'
done

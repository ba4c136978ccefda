#!/usr/bin/env bash
# What was installed runs with what the guest has.
source /hardware/guest/test.sh

for program in /usr/bin/gimbald /usr/bin/gimbalctl "$programs"/*; do
  expect_equal "libraries missing for $program" "$(ldd "$program" | grep 'not found')" ""
done
gimbald --version
gimbalctl --version

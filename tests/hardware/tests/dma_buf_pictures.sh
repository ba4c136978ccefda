#!/usr/bin/env bash
# Pictures that lie in dma-bufs are drawn from, and into, where they lie.
# limit: 900 s
source /hardware/guest/test.sh

[[ -e /dev/dma_heap/system ]] || skip "this kernel has no system heap"
"$programs/dma_buf_test" --gtest_brief=1 2>&1 | tee "$scratch/tests"
((PIPESTATUS[0] == 0)) || fail "what is drawn there is not what copies show"
passed=$(sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' "$scratch/tests")
expect_at_least "tests passed" "${passed:-0}" 19

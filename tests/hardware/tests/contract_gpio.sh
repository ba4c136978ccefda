#!/usr/bin/env bash
# Lines that we drive, watch and share with others, seen from their far end.
source /hardware/guest/test.sh
needs gpio_sim

GIMBALD_TEST_GPIO_SIM=$gpio_folder "$programs/gpio_contract_test" | tee "$scratch/contract"
passed=$(sed -n 's/^\[  PASSED  \] \([0-9]*\) test.*/\1/p' "$scratch/contract")
expect_at_least "tests passed" "${passed:-0}" 10

#!/usr/bin/env bash
# In the tree: builds the unit tests and runs them under qemu-user. The others, without the label, start
# gimbald or gimbalctl, or themselves again (death tests), which the kernel cannot where they are another
# processor's, or take their time.
set -euo pipefail

cmake --build /build --parallel "$(nproc)" --target unit_programs
export GST_PLUGIN_SCANNER=/source/systemd/debian/cross/plugin_scanner.sh
ctest --test-dir /build --label-regex '^unit' --exclude-regex DeathTest --parallel "$(nproc)" --output-on-failure

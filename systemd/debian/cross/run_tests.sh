#!/usr/bin/env bash
# In the tree: builds the unit tests and runs them under qemu-user. The others, without the label, start
# gimbald or gimbalctl, which the kernel cannot where they are another processor's, or take their time.
set -euo pipefail

cmake --build /build --parallel "$(nproc)" --target unit_programs
# Nor can it start the scanner of GStreamer's plugins, which the test's own process can do without.
export GST_REGISTRY_FORK=no
ctest --test-dir /build --label-regex '^unit' --parallel "$(nproc)" --output-on-failure

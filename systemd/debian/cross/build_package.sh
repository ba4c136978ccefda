#!/usr/bin/env bash
# In the tree: cross-compiles the programs and leaves the package in /build.
set -euo pipefail

cmake -S /source -B /build -G Ninja --toolchain /source/cmake/aarch64-linux-gnu.cmake \
  -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_CXX_COMPILER_LAUNCHER=ccache \
  -DGIMBALD_SHARED_DIR=
cmake --build /build --parallel "$(nproc)" --target gimbald gimbalctl
rm -f /build/*.deb
cd /build
cpack -G DEB

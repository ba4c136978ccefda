#!/usr/bin/env bash
# Compiles gimbald for the guest and leaves in a folder its Debian package and, as they lie in the guest's
# root, the test programs and a recording. Compiles only what has changed since the last time.
# Usage: build_program.sh FOLDER TOOLCHAIN CCACHE
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
repository=$(readlink -f "$here/../../..")
source "$here/in_tree.sh"

folder=$1
toolchain=$2
ccache=$3

compile() {
  in_tree "$toolchain" "$ccache" /bin/bash -euc '
    cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
      -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DGIMBALD_SHARED_DIR= \
      -DGIMBALD_OPENCV=OFF -DGIMBALD_CERES=OFF
    cmake --build /build --target gimbald gimbalctl hardware_programs
    rm -rf /program /build/*.deb
    cd /build && cpack -G DEB
    export DESTDIR=/program
    cmake --install /build --strip --component hardware_tests
    mv /build/*.deb /program/
    /build/daemon/gimbalctl/gimbalctl simulate --quiet \
      -o /program/usr/libexec/gimbald-tests/session --size 320x180 --fps 25 --duration 8
    /build/daemon/gimbalctl/gimbalctl simulate --quiet -o /program/usr/libexec/gimbald-tests/motion \
      --size 64x36 --fps 2 --duration 30 --gyro-rate 100 --gyro-bias 0,0,0 --gyro-noise 0 --accel-noise 0'
}

copy_source "$repository" "$toolchain"
compile
rm -rf "$folder"
mv "$toolchain/program" "$folder"

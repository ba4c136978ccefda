#!/usr/bin/env bash
# Compiles gimbald for the guest and leaves in a folder its Debian package and, as they lie in the guest's
# root, the test programs and a recording. Compiles only what has changed since the last time.
# Usage: build_program.sh FOLDER TOOLCHAIN CCACHE
set -euo pipefail
repository=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../..")

folder=$1
toolchain=$2
ccache=$3

# A file keeps its time unless its content changes, so that sources from several checkouts, or from a
# fresh one, do not look new, or old, to ninja.
copy_source() {
  rsync --recursive --links --checksum --delete \
    --exclude=/.git --exclude='/build*' --exclude=/demo-output "$repository/" "$toolchain/source/"
}

# The mounts end with the shell.
compile() {
  # shellcheck disable=SC2016  # expanded by the shell inside
  unshare --mount sh -euc '
    mount --bind "$2" "$1/ccache"
    mount -t proc proc "$1/proc"
    exec chroot "$1" /bin/bash -euc "
      export CCACHE_DIR=/ccache
      cmake -S /source -B /build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX=/usr \
        -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DGIMBALD_SHARED_DIR=
      cmake --build /build --target gimbald gimbalctl hardware_programs
      rm -rf /program /build/*.deb
      cd /build && cpack -G DEB
      export DESTDIR=/program
      cmake --install /build --strip --component hardware_tests
      mv /build/*.deb /program/
      /build/daemon/gimbalctl/gimbalctl simulate --quiet \
        -o /program/usr/libexec/gimbald-tests/session --size 320x180 --fps 25 --duration 8
    "' sh "$toolchain" "$ccache"
}

copy_source
compile
rm -rf "$folder"
mv "$toolchain/program" "$folder"

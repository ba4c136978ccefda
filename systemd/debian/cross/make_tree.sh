#!/usr/bin/env bash
# Makes FOLDER/tree, a Debian 13 for amd64 that compiles for arm64 and runs what it has compiled: compilers
# and tools of its own architecture, the libraries' packages of the other beside them.
# Usage: make_tree.sh FOLDER "LIBRARY'S PACKAGE.."
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")

tree=$1/tree
libraries=$2
tools="crossbuild-essential-arm64 cmake ninja-build ccache dpkg-dev file python3 qemu-user"

"$BASH" "$here/../../../tests/hardware/host/debian_tree.sh" "$tree" "$tools" --architectures=amd64,arm64

# As apt would satisfy the build dependencies of a source package: a library for all architectures, or a
# program that comes with one, is this machine's, the others are the target's.
# shellcheck disable=SC2016  # expanded by the shell inside
chroot "$tree" sh -euc '
  export DEBIAN_FRONTEND=noninteractive
  apt-get -q update
  apt-get -qy -o Dpkg::Use-Pty=0 satisfy --host-architecture arm64 "$1"
  apt-get clean' sh "pkgconf, ${libraries// /, }"

mkdir -p "$tree"/{source,build,ccache}

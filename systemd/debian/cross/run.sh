#!/usr/bin/env bash
# Makes the Debian package for arm64 on amd64, in a Debian 13 of its own, and runs the unit tests there
# under qemu-user. Leaves the package in the folder that GIMBALD_ARM64 names, build/arm64 unless told,
# beside what is kept for the next time: the Debian tree and the compiled objects.
# Usage: run.sh "LIBRARY'S PACKAGE.."
# Exit status: 0 all well; 1 it does not build, the package lacks something or a test fails; 77 this machine
# lacks what is needed.
set -euo pipefail
cross=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
repository=$(readlink -f "$cross/../../..")
host=$repository/tests/hardware/host

# shellcheck source=tests/hardware/host/kept.sh
source "$host/kept.sh" arm64 "$(realpath --canonicalize-missing "${GIMBALD_ARM64:-$repository/build/arm64}")"
# shellcheck source=tests/hardware/host/in_tree.sh
source "$host/in_tree.sh"

make_tree() {
  tree=$(cached tree \
    "$(key_of "@$host/debian_tree.sh" "@$cross/make_tree.sh" "$1")" \
    "$cross/make_tree.sh" "$1")/tree || skip "no Debian tree could be made; is the archive in reach?"
}

in_cross_tree() {
  in_tree "$tree" "$kept/ccache" /bin/bash "/source/systemd/debian/cross/$1"
}

# Only the newest is of use.
keep_package() {
  rm -f "$kept"/gimbald*.deb
  mv "$tree"/build/gimbald*_arm64.deb "$kept/"
}

main() {
  require_tree_tools dpkg
  [[ $(dpkg --print-architecture) == amd64 ]] || skip "arm64 is cross-built on amd64 only"
  mkdir -p "$kept/ccache"
  lock_kept
  make_tree "$1"
  copy_source "$repository" "$tree"
  in_cross_tree build_package.sh
  in_cross_tree check_package.sh
  keep_package
  say "$(echo "$kept"/gimbald*.deb)"
  in_cross_tree run_tests.sh
}

main "$@"

#!/usr/bin/env bash
# Makes two Debian 13 of one day's archive, so that both have the same kernel: FOLDER/guest, which is
# booted, and FOLDER/toolchain, which compiles gimbald and kernel modules for it. All that is ever
# downloaded is downloaded here.
# Usage: build_trees.sh FOLDER "GUEST'S PACKAGE.." "TOOLCHAIN'S PACKAGE.."
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")

folder=$1
guest_packages=$2
toolchain_packages=$3

# The initial RAM disk holds only what reaches the root file system, whatever the host has.
# shellcheck disable=SC2016  # the dollars are for the hooks' shell
make_guest() {
  "$BASH" "$here/debian_tree.sh" "$folder/guest" "$guest_packages" \
    --essential-hook='mkdir -p "$1/etc/initramfs-tools/conf.d" "$1/usr/share/initramfs-tools/modules.d"' \
    --essential-hook='printf "MODULES=list\nFSTYPE=ext4\n" >"$1/etc/initramfs-tools/conf.d/guest"' \
    --essential-hook='printf "%s\n" virtio_pci virtio_blk ext4 >"$1/usr/share/initramfs-tools/modules.d/guest"'
}

make_toolchain() {
  local tree=$folder/toolchain
  "$BASH" "$here/debian_tree.sh" "$tree" "$toolchain_packages"
  mkdir -p "$tree"/{source,build,ccache,packages}
  # Taken apart, not installed: the package would want to compile for the running kernel.
  chroot "$tree" sh -euc 'cd /packages; apt-get -q update
    apt-get -q -o APT::Sandbox::User=root download v4l2loopback-dkms'
}

make_guest >"$folder/guest.log" 2>&1 &
guest=$!
make_toolchain
wait "$guest" || {
  cat "$folder/guest.log"
  exit 1
}

#!/usr/bin/env bash
# Makes what the emulator boots: image/{kernel,initrd,disk}.
# Usage: build_image.sh FOLDER GUEST MODULES
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
guest_files=$here/../guest/system

folder=$1
guest=$2
modules=$3
kernel=$(basename "$guest"/usr/lib/modules/*)

readonly spare_mb=400

# The modules go where depmod looks last, so that none replaces one of the kernel's own.
add_modules() {
  install -D -m 644 -t "$guest/usr/lib/modules/$kernel/extra" "$modules"/*.ko
  chroot "$guest" depmod "$kernel"
}

# A guest without logins, housekeeping and network, that runs one command and ends.
configure() {
  echo gimbald-guest >"$guest/etc/hostname"
  install -m 644 "$guest_files/fstab" "$guest/etc/fstab"
  install -m 644 "$guest_files/guest-command.service" "$guest/etc/systemd/system/"
  mkdir -p "$guest"/{hardware,program,exchange}
  local unit
  while read -r unit; do
    ln -sf /dev/null "$guest/etc/systemd/system/$unit"
  done < <(sed 's/ *#.*//; /^$/d' "$guest_files/masked-units.txt")
  chroot "$guest" systemctl --quiet enable guest-command.service
}

# GStreamer looks through its plugins once; emulated, that takes it half a minute.
know_plugins() { chroot "$guest" env HOME=/root gst-inspect-1.0 >/dev/null; }

add_modules
configure
know_plugins
cp "$guest/boot/vmlinuz-$kernel" "$folder/kernel"
cp "$guest/boot/initrd.img-$kernel" "$folder/initrd"
megabytes=$(du -sm "$guest" | cut -f1)
mke2fs -q -t ext4 -O ^has_journal -m 0 -d "$guest" "$folder/disk" "$((megabytes + spare_mb))M"

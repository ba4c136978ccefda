#!/usr/bin/env bash
# Compiles the kernel's virtual devices that Debian leaves off (gpio-sim, vimc) and v4l2loopback,
# from Debian's own source packages.
# Usage: build_modules.sh FOLDER TOOLCHAIN KERNEL
set -euo pipefail

folder=$1
toolchain=$2
kernel=$3
work=$toolchain/modules

unpack_kernel_parts() {
  tar -C "$work/linux" --strip-components=1 --wildcards -xf "$toolchain"/usr/src/linux-source-*.tar.xz \
    '*/drivers/gpio/gpio-sim.c' '*/kernel/irq/irq_sim.c' '*/drivers/media/test-drivers/vimc'
}

unpack_v4l2loopback() {
  dpkg-deb --fsys-tarfile "$toolchain"/packages/v4l2loopback-dkms_*.deb |
    tar -C "$work/v4l2loopback" --strip-components=4 --wildcards -xf - './usr/src/v4l2loopback-*'
}

# gpio-sim needs the simulated interrupts that Debian's kernel is built without. They are linked into
# the module; there a descriptor cannot be looked up, but its number does as well.
lay_out_gpio_sim() {
  mkdir "$work/gpio_sim"
  cp "$work/linux/drivers/gpio/gpio-sim.c" "$work/gpio_sim/chip.c"
  sed 's/handle_simple_irq(irq_to_desc(\(\w*\)))/generic_handle_irq(\1)/' \
    "$work/linux/kernel/irq/irq_sim.c" >"$work/gpio_sim/interrupts.c"
  cat >"$work/gpio_sim/Kbuild" <<'KBUILD'
obj-m := gpio-sim.o
gpio-sim-y := chip.o interrupts.o
KBUILD
}

compile() {
  chroot "$toolchain" make -s -C "/usr/src/linux-headers-$kernel" M="/modules/$1" "${@:2}" modules
  find "$work/$1" -name '*.ko' -exec cp -t "$folder" {} +
}

rm -rf "$work"
mkdir -p "$work/linux" "$work/v4l2loopback"
unpack_kernel_parts
lay_out_gpio_sim
compile gpio_sim
compile linux/drivers/media/test-drivers/vimc CONFIG_VIDEO_VIMC=m
unpack_v4l2loopback
compile v4l2loopback
rm -rf "$work"

#!/usr/bin/env bash
# In the tree: says what of the package in /build is not as a machine with arm64 needs it.
set -euo pipefail

package=$(echo /build/gimbald_*.deb)
unpacked=$(mktemp --directory)
trap 'rm -rf "$unpacked"' EXIT

die() {
  echo "arm64: $package: $*" >&2
  exit 1
}

# Libraries that are linked and that dpkg-shlibdeps must therefore have found, the C library the first.
check_fields() {
  local depends library
  [[ $(dpkg-deb --field "$package" Architecture) == arm64 ]] || die "is not for arm64"
  depends=$(dpkg-deb --field "$package" Depends)
  for library in libc6 libstdc++6 libegl1 libgles2 libgbm1 libgstreamer1.0-0 libgstrtspserver-1.0-0 \
    libcamera0 libiio0 libgpiod libsystemd0 libturbojpeg0; do
    [[ ", $depends" == *", $library"* ]] || die "does not depend on $library"
  done
}

check_programs() {
  local program kind
  for program in gimbald gimbalctl; do
    kind=$(file --brief "$unpacked/usr/bin/$program")
    [[ $kind == *"ARM aarch64"* ]] || die "$program is $kind"
    [[ $kind != *"not stripped"* ]] || die "$program is not stripped"
    qemu-aarch64 "$unpacked/usr/bin/$program" --version
  done
}

check_configuration() {
  qemu-aarch64 "$unpacked/usr/bin/gimbald" --config "$unpacked/etc/gimbald/gimbald.toml" --check-config
}

dpkg-deb --info "$package"
dpkg-deb --extract "$package" "$unpacked"
check_fields
check_programs
check_configuration

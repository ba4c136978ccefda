#!/usr/bin/env bash
# Boots the guest, runs one command in it as root, prints its output and ends with its status.
# Usage: run_in_guest.sh [-t SECONDS] IMAGE PROGRAM EXCHANGE COMMAND
#   IMAGE     a folder made by build_image.sh; nothing in it changes
#   PROGRAM   the folder that the guest sees as /program
#   EXCHANGE  an empty folder, /exchange in the guest, where the command may leave files; console.log
#             is there afterwards
#   -t        gives up after so many seconds, 600 unless told
# Exit status: the command's; 124 if time ran out; 125 if the guest ended before the command did.
set -euo pipefail
hardware=$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")

seconds=600
if [[ $1 == -t ]]; then
  seconds=$2
  shift 2
fi
image=$1 program=$2 exchange=$3 command=$4

readonly status_time_ran_out=124 status_guest_died=125

# Only a processor that says so runs a guest by itself: a /dev/kvm that is there without it emulates
# worse than the emulator. AVX2 is left out of what is emulated: qemu 7.2's gather instructions fault at
# addresses that nobody asked for.
acceleration() {
  if [[ -w /dev/kvm ]] && grep -qwE 'vmx|svm' /proc/cpuinfo; then
    echo -accel kvm -cpu host
  else
    echo -accel tcg,thread=multi -cpu max,-avx2
  fi
}

share() {
  local name=$1 folder=$2 access=$3
  echo -fsdev "local,id=$name,path=$folder,security_model=none,multidevs=remap$access" \
    -device "virtio-9p-pci,fsdev=$name,mount_tag=$name"
}

boot() {
  # shellcheck disable=SC2046  # each prints several options
  timeout "$seconds" qemu-system-x86_64 -M q35 $(acceleration) -smp 2 -m 2048 \
    -nodefaults -display none -no-reboot -net none -serial "file:$exchange/console.log" \
    -kernel "$image/kernel" -initrd "$image/initrd" \
    -append "console=ttyS0 loglevel=4 panic=-1 mitigations=off root=/dev/vda rw" \
    -drive "file=$image/disk,format=raw,if=none,id=disk,snapshot=on" \
    -device virtio-blk-pci,drive=disk -device virtio-rng-pci \
    $(share hardware "$hardware" ,readonly=on) $(share program "$program" ,readonly=on) \
    $(share exchange "$exchange" "") </dev/null >"$exchange/emulator.log" 2>&1
}

# The output of the command as it comes.
printf '%s\n' "$command" >"$exchange/command"
: >"$exchange/output"
boot &
emulator=$!
trap 'kill "$emulator" 2>/dev/null || true' EXIT
tail --pid="$emulator" -n +1 -f "$exchange/output"
ended=0
wait "$emulator" || ended=$?

((ended != 124)) || exit "$status_time_ran_out"
[[ -s $exchange/status ]] || exit "$status_guest_died"
exit "$(cat "$exchange/status")"

# shellcheck shell=bash
# A sensor, an image processor and the nodes between them, for libcamera: the kernel's vimc. Its
# links are as it makes them; formats are for who uses it to set. Sets vimc_media, its media device.

plug_vimc() {
  load vimc
  local media
  for media in /dev/media*; do
    if media-ctl -d "$media" --print-topology | grep -qx 'driver *vimc'; then vimc_media=$media; fi
  done
  [[ -n ${vimc_media:-} ]] || fail "no media device of vimc"
}

unplug_vimc() { modprobe -r vimc; }

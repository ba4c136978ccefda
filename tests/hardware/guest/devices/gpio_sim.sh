# shellcheck shell=bash
# A GPIO chip with four lines, of which 0 is named "strobe", 1 "data-ready", 2 "button" and 3 "led": the
# kernel's gpio-sim. Sets gpio_chip, such as gpiochip0.

readonly gpio_bank=/sys/kernel/config/gpio-sim/tests/bank

plug_gpio_sim() {
  load gpio-sim
  mkdir -p "$gpio_bank"
  echo 4 >"$gpio_bank/num_lines"
  local line=0 name
  for name in strobe data-ready button led; do
    mkdir "$gpio_bank/line$line"
    echo "$name" >"$gpio_bank/line$line/name"
    ((++line))
  done
  echo 1 >"${gpio_bank%/*}/live"
  udevadm settle
  gpio_chip=$(cat "$gpio_bank/chip_name")
  gpio_folder=/sys/devices/platform/$(cat "${gpio_bank%/*}/dev_name")/$gpio_chip
}

unplug_gpio_sim() {
  echo 0 >"${gpio_bank%/*}/live"
  rmdir "$gpio_bank"/line* "$gpio_bank" "${gpio_bank%/*}"
  modprobe -r gpio-sim
}

# pull LINE up|down: as if a device drove it so
pull() { echo "pull-$2" >"$gpio_folder/sim_gpio$1/pull"; }

# level LINE: 0 or 1, as it is driven
level() { cat "$gpio_folder/sim_gpio$1/value"; }

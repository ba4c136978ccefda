# shellcheck shell=bash
# An I²C bus with nothing but memory at the addresses 0x68 and 0x69, as a chip's registers look to one
# who reads bytes and blocks. Sets i2c_bus, the bus' number.

plug_i2c_stub() {
  modprobe i2c-dev
  load i2c-stub chip_addr=0x68,0x69
  i2c_bus=$(i2cdetect -l | sed -n 's/^i2c-\([0-9]*\).*SMBus stub.*/\1/p')
  [[ -n $i2c_bus ]] || fail "no bus of i2c-stub"
}

unplug_i2c_stub() { modprobe -r i2c-stub; }

# set_registers ADDRESS REGISTER BYTE..: the bytes into registers one after the other, whether or not a
# driver has the address
set_registers() {
  local address=$1 register=$2 byte
  shift 2
  for byte in "$@"; do
    i2cset -f -y "$i2c_bus" "$address" "$register" "$byte"
    ((++register))
  done
}

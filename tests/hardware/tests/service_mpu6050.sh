#!/usr/bin/env bash
# The user-space driver of the MPU-6050, on a bus that knows SMBus alone; each sample has the kernel's stamp of
# its data-ready edge.
# limit: 600 s
source /hardware/guest/test.sh
source /hardware/guest/service.sh
needs vivid i2c_stub mpu6050 gpio_sim

readonly folder=/var/lib/gimbald/recordings
is_upright() { [[ $(status_of '.orientation.degrees | (.elevation | fabs) < 3 and (.roll | fabs) < 3') == true ]]; }
have_sampled() { (($(status_of .imu.samples) >= $1)); }

# "before after" of each edge, on CLOCK_MONOTONIC, of which the kernel prints hundredths
keep_data_ready() {
  local before after never
  mkfifo "$scratch/never"
  exec {never}<>"$scratch/never"
  while true; do
    read -r before _ </proc/uptime
    pull 1 up
    read -r after _ </proc/uptime
    echo "$before $after"
    read -r -t 0.0$((1 + RANDOM % 9)) -u "$never" || true  # a sleep that starts no process
    pull 1 down
  done
}
end_data_ready() { kill "$data_ready" 2>/dev/null || true; }

# Accelerometer, thermometer, gyroscope: upright, for a camera whose y is down, at 2048 steps a g; and 1, 2
# and 3 steps of 2000 deg/s in 2^15.
set_registers "$mpu6050_address" 0x3b 0 0 0xf8 0 0 0 0 0 0 1 0 2 0 3
keep_data_ready >"$scratch/edges" &
data_ready=$!
unplugging=(end_data_ready "${unplugging[@]}")

start_service <<TOML
outputs = ["identity ! fakesink"]
$camera
[imu]
driver = "i2c_mpu6500"
[i2c]
bus = "$mpu6050_bus"
address = $mpu6050_address
delivery = "polling"
data_ready = "$gpio_chip:1"
[recording]
folder = "$folder"
min_free_mb = 0
TOML
wait_until "10 pictures are shown" have_shown 10
gimbalctl record start
recording=$(status_of .recording.folder)
wait_until "samples of both sensors are there" have_sampled $(($(status_of .imu.samples) + 240))
gimbalctl record stop

wait_until "the camera stands upright" is_upright
awk -F '[ ,]' '
  FNR == NR { before[edges] = $1; after[edges++] = $2 + 0.01; next }
  FNR == 1 { next }
  {
    for (axis = 1; axis <= 3; axis++) {
      steps = $(axis + 1) * 57.29578 / 2000 * 32768
      if (steps < axis - 0.01 || steps > axis + 0.01) { printf "%s is not measured\n", $0; failed = 1; exit }
    }
    while (edge < edges && after[edge] < $1) edge++
    if (edge == edges || $1 < before[edge]) { printf "no edge at %s\n", $1; failed = 1; exit }
    edge++
    samples++
  }
  END {
    printf "%d samples with their edges\n", samples
    exit failed || samples < 100
  }' "$scratch/edges" "$recording/gyro.csv"

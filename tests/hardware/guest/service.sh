# shellcheck shell=bash
# gimbald as systemd runs it from the installed package. What a test configures is gone when it ends.

readonly service_folder=/etc/systemd/system/gimbald.service.d
readonly camera='
[camera]
driver = "v4l2"
horizontal_fov_deg = 60
readout_s = 0.03
[v4l2]
width = 640
height = 360
fps = 25
pixel_format = "NV12"
[stabilization]
warper = "cpu"
'
# Tables that a test adds keys to come last: [stabilization].
readonly camera_and_imu='
[imu]
driver = "iio"
[iio]
device = "gyro_3d"
rate_hz = 100
'$camera

# start_service: with the configuration on standard input. An emulated guest takes its time, so what is waited
# for has more of it than on a real machine.
start_service() {
  unplugging=(stop_service "${unplugging[@]}")
  cp /etc/gimbald/gimbald.toml "$scratch/shipped.toml"
  cat >/etc/gimbald/gimbald.toml
  mkdir -p "$service_folder"
  printf '[Service]\nTimeoutStartSec=300\nWatchdogSec=%s\n' "${watchdog_s:-60}" >"$service_folder/slow.conf"
  systemctl daemon-reload
  rm -f /var/lib/gimbald/gyro-bias-*  # another test's device had it
  since=$(date '+%F %T')
  # A first start may fail on a busy guest (a camera whose stamps are late); it is then started again.
  systemctl start --no-block gimbald
  wait_until "the service is active" is_active
}

# A service with camera and IMU, whose pictures nobody sees, once it shows some. Sets process.
start_usual_service() {
  start_service <<TOML
outputs = ["identity ! fakesink"]
$camera_and_imu
TOML
  wait_until "10 pictures are shown" have_shown 10
  process=$(main_process)
}

stop_service() {
  status_of '{degraded, orientation, imu} | tostring' || true
  service_says | tail -n 20
  systemctl stop gimbald
  cp "$scratch/shipped.toml" /etc/gimbald/gimbald.toml
  rm -r "$service_folder"
  systemctl daemon-reload
  systemctl reset-failed gimbald 2>/dev/null || true
}

service_says() { journalctl --no-pager -o cat --since "$since" -u gimbald; }
has_said() { service_says | grep -q "$1"; }

service_property() { systemctl show --property "$1" --value gimbald; }
is_active() { [[ $(service_property ActiveState) == active ]]; }
main_process() { service_property MainPID; }
has_started_again() { (($(service_property NRestarts) >= $1)) && is_active; }

# status_of FILTER: what jq finds in the status, such as .frames.out
status_of() { gimbalctl status --json | jq -r "$1"; }

# What does not work, such as "no-camera no-imu".
degraded() { status_of '.degraded | join(" ")'; }
is_degraded() { [[ " $(degraded) " == *" $1 "* ]]; }
is_not_degraded() { ! is_degraded "$1"; }

# Pictures that the outputs were given, stabilized or not.
pictures_shown() { status_of '.frames.out + .frames.no_signal'; }
have_shown() { (($(pictures_shown) >= $1)); }

# Pictures go on being shown, from now.
expect_pictures_go_on() {
  local now
  now=$(pictures_shown)
  wait_until "10 more pictures are shown" have_shown $((now + 10))
}

# A pipe that the service may write to, until the test ends. Sets pipe.
make_pipe() {
  pipe=/var/lib/gimbald/pipe
  install -d -o gimbald -g gimbald -m 750 "${pipe%/*}"
  mkfifo "$pipe"
  chown gimbald "$pipe"
  unplugging+=(remove_pipe)
}
remove_pipe() { rm "$pipe"; }

# have_written NUMBER [COUNT]: the outputs' number NUMBER, from 0, has taken so many pictures
have_written() { (($(status_of ".outputs[$1].written") >= ${2:-1})); }

# stamps_of PIPELINE..: in ns, of what comes out of the pipeline, until it ends or has come 20 times
stamps_of() {
  timeout 200 gst-launch-1.0 -v "$@" ! identity silent=false ! fakesink num-buffers=20 sync=false 2>&1 |
    sed -n 's/.*last-message = chain .* pts: \([0-9]*\):\([0-9]*\):\([0-9]*\)\.\([0-9]*\),.*/\1 \2 \3 \4/p' |
    awk '{ printf "%d%s\n", ($1 * 60 + $2) * 60 + $3, $4 }'
}

# Every picture that came in went out or was counted; said when the service has ended.
expect_all_accounted_for() {
  local in out unknown slow
  read -r in out unknown slow < <(service_says | sed -n \
    's/^\([0-9]*\) frames in, \([0-9]*\) out, \([0-9]*\) dropped for want of orientation, \([0-9]*\) before.*/\1 \2 \3 \4/p')
  expect_equal "frames out or dropped" $((out + unknown + slow)) "$in"
}

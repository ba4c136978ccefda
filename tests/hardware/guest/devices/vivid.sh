# shellcheck shell=bash
# A camera: the kernel's vivid, 640x360 NV12 at 25 frames/s, stamped on CLOCK_MONOTONIC at the end of
# each frame. Sets vivid_node.

plug_vivid() {
  load vivid n_devs=1 node_types=0x1 input_types=0x0
  vivid_node=$(node_of_driver vivid)
  v4l2-ctl -d "$vivid_node" --set-fmt-video=width=640,height=360,pixelformat=NV12 >/dev/null
  v4l2-ctl -d "$vivid_node" --set-parm=25 >/dev/null
}

unplug_vivid() { modprobe -r vivid; }

# The first video node whose driver has this name.
node_of_driver() {
  local node
  for node in /dev/video*; do
    if v4l2-ctl -d "$node" --info 2>/dev/null | grep -q "Driver name *: $1"; then
      echo "$node"
      return
    fi
  done
  fail "no video node of $1"
}

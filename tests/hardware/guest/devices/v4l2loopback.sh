# shellcheck shell=bash
# A video node that one program writes and others read, as a camera. Sets loopback_node.

plug_v4l2loopback() {
  load v4l2loopback video_nr=42 exclusive_caps=1 card_label=loopback
  loopback_node=/dev/video42
  [[ -c $loopback_node ]] || fail "no $loopback_node"
}

unplug_v4l2loopback() { modprobe -r v4l2loopback; }

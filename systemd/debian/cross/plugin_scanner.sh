#!/bin/sh
# In the tree: GStreamer's scanner of plugins, which the kernel cannot start by itself. Without a scanner the
# program that asks reads them all, and the first that fails to load ends it.
exec qemu-aarch64 /usr/lib/aarch64-linux-gnu/gstreamer1.0/gstreamer-1.0/gst-plugin-scanner "$@"

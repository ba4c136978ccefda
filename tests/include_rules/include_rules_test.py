#!/usr/bin/env python3
"""Shows that include_rules.py lets through what is allowed and finds what is not."""

import unittest

from include_rules import violations

ALLOWED = [
    ("pipeline/sample/a.hpp", "<vector>"),
    ("pipeline/sample/a.hpp", "<Eigen/Core>"),
    ("pipeline/sample/a.hpp", "<tl/expected.hpp>"),
    ("pipeline/sample/a.hpp", '"pipeline/sample/b.hpp"'),
    ("pipeline/timing/a.cpp", '"pipeline/sample/b.hpp"'),
    ("pipeline/timing/a.cpp", '"pipeline/queue/b.hpp"'),
    ("pipeline/warp/a.cpp", '"pipeline/lens/b.hpp"'),
    ("pipeline/warp/a.cpp", '"pipeline/pixels/b.hpp"'),
    ("pipeline/warp/a.cpp", "<EGL/egl.h>"),
    ("pipeline/warp/a.cpp", "<GLES3/gl3.h>"),
    ("pipeline/sink/a.cpp", "<gst/gst.h>"),
    ("pipeline/sink/a.cpp", '"pipeline/gstreamer/b.hpp"'),
    ("pipeline/sync/a.cpp", "<opencv2/video/tracking.hpp>"),
    ("pipeline/queue/a.hpp", "<thread>"),
    ("pipeline/stabilizer.cpp", '"pipeline/path/b.hpp"'),
    ("drivers/camera_source.hpp", '"pipeline/sample/b.hpp"'),
    ("drivers/driver_table.cpp", '"drivers/replay/b.hpp"'),
    ("drivers/replay/a.cpp", '"drivers/camera_source.hpp"'),
    ("drivers/replay/a.cpp", '"pipeline/lens/b.hpp"'),
    ("drivers/replay/a.cpp", "<gst/app/gstappsink.h>"),
    ("drivers/replay/a.cpp", '"pipeline/gstreamer/b.hpp"'),
    ("drivers/replay/a.cpp", "<toml++/toml.h>"),
    ("drivers/v4l2/a.cpp", "<linux/videodev2.h>"),
    ("drivers/v4l2/a.cpp", '"pipeline/pixels/b.hpp"'),
    ("drivers/libcamera/a.cpp", '"pipeline/pixels/b.hpp"'),
    ("drivers/libcamera/a.cpp", "<libcamera/libcamera.h>"),
    ("drivers/gpio/a.cpp", "<gpiod.hpp>"),
    ("drivers/i2c/a.cpp", "<linux/i2c-dev.h>"),
    ("drivers/i2c_icm42688/a.cpp", '"drivers/i2c/b.hpp"'),
    ("drivers/iio/a.cpp", '"drivers/clock/b.hpp"'),
    ("drivers/iio/a.cpp", '"drivers/device_report.hpp"'),
    ("drivers/iio/a.cpp", '"drivers/stop_event.hpp"'),
    ("daemon/main.cpp", '"pipeline/stabilizer.hpp"'),
    ("daemon/main.cpp", "<systemd/sd-daemon.h>"),
    ("daemon/gimbalctl/a.cpp", "<CLI/CLI.hpp>"),
    ("tests/unit/warp/a.cpp", '"tests/support/b.hpp"'),
    ("tests/unit/warp/a.cpp", '"daemon/b.hpp"'),
    ("tests/unit/warp/a.cpp", "<opencv2/core.hpp>"),
]

FORBIDDEN = [
    ("pipeline/sample/a.hpp", "<fmt/core.h>"),
    ("pipeline/sample/a.hpp", "<unistd.h>"),
    ("pipeline/sample/a.hpp", '"pipeline/lens/b.hpp"'),
    ("pipeline/sample/a.hpp", '"pipeline/queue/b.hpp"'),
    ("pipeline/lens/a.cpp", '"pipeline/warp/b.hpp"'),
    ("pipeline/path/a.cpp", '"pipeline/stabilizer.hpp"'),
    ("pipeline/path/a.cpp", '"drivers/camera_source.hpp"'),
    ("pipeline/path/a.cpp", '"daemon/b.hpp"'),
    ("pipeline/path/a.cpp", '"tests/support/b.hpp"'),
    ("pipeline/path/a.cpp", "<thread>"),
    ("pipeline/path/a.cpp", "<sys/ioctl.h>"),
    ("pipeline/stabilizer.cpp", '"drivers/replay/b.hpp"'),
    ("pipeline/sink/a.cpp", "<EGL/egl.h>"),
    ("pipeline/warp/a.cpp", "<gst/gst.h>"),
    ("pipeline/warp/a.cpp", "<opencv2/core.hpp>"),
    ("pipeline/warp/a.cpp", '"warp_mesh.hpp"'),
    ("pipeline/warp/a.cpp", "<acme/unknown.hpp>"),
    ("drivers/camera_source.hpp", '"drivers/replay/b.hpp"'),
    ("drivers/replay/a.cpp", '"drivers/synthetic/b.hpp"'),
    ("drivers/replay/a.cpp", '"drivers/i2c/b.hpp"'),
    ("drivers/i2c_icm42688/a.cpp", '"drivers/i2c_mpu6500/b.hpp"'),
    ("drivers/i2c_icm42688/a.cpp", "<linux/i2c-dev.h>"),
    ("drivers/replay/a.cpp", '"pipeline/sink/b.hpp"'),
    ("drivers/replay/a.cpp", '"pipeline/stabilizer.hpp"'),
    ("drivers/replay/a.cpp", '"daemon/b.hpp"'),
    ("drivers/replay/a.cpp", "<linux/videodev2.h>"),
    ("drivers/libcamera/a.cpp", "<linux/videodev2.h>"),
    ("drivers/v4l2/a.cpp", "<libcamera/libcamera.h>"),
    ("drivers/iio/a.cpp", '"pipeline/pixels/b.hpp"'),
    ("drivers/synthetic/a.cpp", "<gst/gst.h>"),
    ("drivers/synthetic/a.cpp", '"pipeline/gstreamer/b.hpp"'),
    ("pipeline/warp/a.cpp", '"pipeline/gstreamer/b.hpp"'),
    ("drivers/iio/a.cpp", "<gpiod.h>"),
    ("drivers/v4l2/a.cpp", "<systemd/sd-daemon.h>"),
    ("daemon/main.cpp", '"tests/support/b.hpp"'),
    ("daemon/main.cpp", "<GLES2/gl2.h>"),
]


def violations_of(path, header):
    return list(violations([(path, f"#pragma once\n#include {header}\n")]))


class IncludeRules(unittest.TestCase):
    def test_lets_through_what_is_allowed(self):
        for path, header in ALLOWED:
            with self.subTest(path=path, header=header):
                self.assertEqual(violations_of(path, header), [])

    def test_finds_what_is_forbidden(self):
        for path, header in FORBIDDEN:
            with self.subTest(path=path, header=header):
                self.assertEqual(len(violations_of(path, header)), 1)

    def test_says_where(self):
        (line,) = violations_of("pipeline/sink/a.cpp", "<EGL/egl.h>")
        self.assertTrue(line.startswith("pipeline/sink/a.cpp:2: "), line)

    def test_sees_through_spaces(self):
        text = '  #  include   "daemon/b.hpp"'
        self.assertEqual(len(list(violations([("pipeline/path/a.cpp", text)]))), 1)

    def test_skips_comments(self):
        text = '// #include "daemon/b.hpp"\n'
        self.assertEqual(list(violations([("pipeline/path/a.cpp", text)])), [])

    def test_finds_a_circle_of_folders(self):
        files = [
            ("pipeline/lens/a.hpp", '#include "pipeline/warp/a.hpp"'),
            ("pipeline/warp/a.hpp", '#include "pipeline/lens/a.hpp"'),
        ]
        circles = [line for line in violations(files) if "circle" in line]
        self.assertEqual(len(circles), 1)
        self.assertIn("pipeline/lens -> pipeline/warp -> pipeline/lens", circles[0])


if __name__ == "__main__":
    unittest.main()

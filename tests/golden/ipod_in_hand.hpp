#pragma once

#include "drivers/synthetic/motion.hpp"
#include "pipeline/sample/calibration.hpp"

namespace gimbal::test {

/// The iPod touch 4 of the thesis (2.6) at 1280x720 and 30 frames a second, readout 30 ms.
[[nodiscard]] CameraCalibration ipod_touch();

/// A phone's sensors behind its rear camera, held in landscape.
[[nodiscard]] ImuCalibration phone_axes();

/// Part of the log of a real hand that lies beside the synthetic camera; its time zero is at
/// `start_s`. Throws where the log cannot be read.
[[nodiscard]] Motion hand_motion(double start_s, double duration_s);

}  // namespace gimbal::test

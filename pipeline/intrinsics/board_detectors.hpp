#pragma once

#include <memory>

#include "pipeline/intrinsics/board_detector.hpp"

namespace gimbal {

[[nodiscard]] std::unique_ptr<BoardDetector> make_checkerboard_detector(
    const CalibrationBoard& board);

/// OpenCV renamed its ArUco and moved it to another library between the 4.6 of Debian 12 and the
/// 4.10 of Debian 13: there is a file for each, and one where neither is there.
[[nodiscard]] Result<std::unique_ptr<BoardDetector>> make_charuco_detector(
    const CalibrationBoard& board);

}  // namespace gimbal

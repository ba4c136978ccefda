#include "pipeline/intrinsics/board_detectors.hpp"

namespace gimbal {

Result<std::unique_ptr<BoardDetector>> make_charuco_detector(const CalibrationBoard& /*board*/) {
  return bad_input(
      "charuco: built without OpenCV's ArUco; take a checkerboard, or install "
      "libopencv-contrib-dev (Debian 12) or libopencv-objdetect-dev (13) and build it again");
}

}  // namespace gimbal

#pragma once

#include <string>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// OpenCV's number of a predefined dictionary by its name there, such as "DICT_4X4_50"; bad_input
/// for others.
[[nodiscard]] Result<int> aruco_dictionary(const std::string& name);

/// bad_input unless the markers fit into the squares and the dictionary has enough of them.
[[nodiscard]] Result<void> check_markers(const CalibrationBoard& board, int markers);

}  // namespace gimbal

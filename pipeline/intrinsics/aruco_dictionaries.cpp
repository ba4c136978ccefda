#include "pipeline/intrinsics/aruco_dictionaries.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace gimbal {
namespace {

/// In the order of OpenCV's cv::aruco::PREDEFINED_DICTIONARY_NAME, whose numbers are for good.
constexpr std::array<std::string_view, 21> kNames = {
    "DICT_4X4_50",         "DICT_4X4_100",       "DICT_4X4_250",       "DICT_4X4_1000",
    "DICT_5X5_50",         "DICT_5X5_100",       "DICT_5X5_250",       "DICT_5X5_1000",
    "DICT_6X6_50",         "DICT_6X6_100",       "DICT_6X6_250",       "DICT_6X6_1000",
    "DICT_7X7_50",         "DICT_7X7_100",       "DICT_7X7_250",       "DICT_7X7_1000",
    "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10",
    "DICT_APRILTAG_36h11"};

}  // namespace

Result<int> aruco_dictionary(const std::string& name) {
  const auto found = std::find(kNames.begin(), kNames.end(), name);
  if (found != kNames.end()) return static_cast<int>(found - kNames.begin());
  return bad_input(fmt::format("there is no dictionary of markers \"{}\"; there are {}", name,
                               fmt::join(kNames, ", ")));
}

Result<void> check_markers(const CalibrationBoard& board, int markers) {
  if (!(board.marker_squares > 0 && board.marker_squares < 1)) {
    return bad_input("the markers of a charuco board must be smaller than its squares");
  }
  const int needed = board.columns * board.rows / 2;
  if (needed <= markers) return {};
  return bad_input(fmt::format("a board of {}x{} squares has {} markers, but {} has only {}",
                               board.columns, board.rows, needed, board.dictionary, markers));
}

}  // namespace gimbal

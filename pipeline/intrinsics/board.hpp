#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"

namespace gimbal {

enum class BoardKind : std::uint8_t { checkerboard, charuco };

/// A flat board whose corners a camera is calibrated by.
struct CalibrationBoard {
  BoardKind kind = BoardKind::checkerboard;
  /// A checkerboard's inner corners, a ChArUco board's squares, as OpenCV counts them.
  int columns = 0;
  int rows = 0;
  /// Of a ChArUco board: a marker's side in squares, and OpenCV's name of the dictionary.
  double marker_squares = 0;
  std::string dictionary;

  /// Inner corners of squares, of which all or, with ChArUco, some are seen.
  [[nodiscard]] int corner_count() const;
};

/// Reads "checkerboard:9x6" or "charuco:5x7"; bad_input for other kinds and for boards too small.
[[nodiscard]] Result<CalibrationBoard> parse_board(const std::string& text);

/// What was seen of a board in one picture.
struct BoardView {
  std::string name;                      ///< of the picture, for people
  std::vector<Eigen::Vector2d> corners;  ///< on the board, in squares
  std::vector<Eigen::Vector2d> seen_px;  ///< the same in the picture
  double sharpness = 0;                  ///< of the edges at the corners: 1 over their width in px
};

}  // namespace gimbal

#pragma once

#include <memory>
#include <optional>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace cv {
class Mat;
}

namespace gimbal {

/// Finds the corners of a board in pictures, to a fraction of a pixel.
class BoardDetector {
 public:
  /// bad_input for a dictionary that there is not or that has too few markers, for markers that do
  /// not fit into their squares, and for a ChArUco board where OpenCV's ArUco was not there to
  /// build with.
  [[nodiscard]] static Result<std::unique_ptr<BoardDetector>> create(const CalibrationBoard& board);

  explicit BoardDetector(double clear_share) : clear_share_(clear_share) {}
  BoardDetector(const BoardDetector&) = delete;
  BoardDetector& operator=(const BoardDetector&) = delete;
  virtual ~BoardDetector() = default;

  /// Nothing if the board is not there: of a checkerboard all corners must be seen, of a ChArUco
  /// board some in two rows and columns at least. The view has no name yet.
  [[nodiscard]] std::optional<BoardView> find(const VideoFrame& frame) const;

 private:
  /// Corners alone, to a pixel or so; may throw what OpenCV throws.
  [[nodiscard]] virtual BoardView look(const cv::Mat& luma) const = 0;

  double clear_share_;  ///< of the way to the nearest corner, in which there is nothing else
};

}  // namespace gimbal

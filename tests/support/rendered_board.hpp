#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/intrinsics/board.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal::test {

/// How bright the board is at a place on it, in squares; its first inner corner is at (0, 0). What
/// is drawn reaches beyond the inner corners by a square and a white margin.
using BoardTexture = std::function<double(const Eigen::Vector2d&)>;

[[nodiscard]] BoardTexture board_texture(const CalibrationBoard& board);

/// What a camera makes of it.
struct PictureFaults {
  double blur_px = 0.7;  ///< standard deviation
  double noise = 3;      ///< standard deviation, in steps of luma
};

/// Pictures of a board by a lens that is known to the last bit.
class BoardRenderer {
 public:
  BoardRenderer(const Lens& lens, ImageSize size, BoardTexture texture, PictureFaults faults);

  /// `T_camera_board`: of places on the board in squares, z 0. Noise by the seed.
  [[nodiscard]] VideoFrame render(const Eigen::Isometry3d& T_camera_board,
                                  std::uint64_t seed) const;

 private:
  [[nodiscard]] double brightness(const Eigen::Isometry3d& T_board_camera, int x, int y) const;

  ImageSize size_;
  BoardTexture texture_;
  PictureFaults faults_;
  std::vector<Eigen::Vector3d> rays_;  ///< of the pixels' corners, a row more and a column more
};

/// What a board without tilt faces, wherever it is in the picture.
enum class Facing : std::uint8_t { camera, picture_plane };

struct BoardPoses {
  double tilt_rad = 0.6;  ///< away from the picture's plane, at most
  double share = 0.45;    ///< of the picture's width that the board takes up, about
  Facing facing = Facing::camera;
  double reach = 1;  ///< how far out its middle goes: 1 to where the board still fits
};

/// Poses at random in which the whole board is in the picture.
[[nodiscard]] std::vector<Eigen::Isometry3d> board_poses(const CalibrationBoard& board,
                                                         const Lens& lens, ImageSize size,
                                                         int count, std::uint64_t seed,
                                                         const BoardPoses& how = {});

/// What a detector with this much noise in each coordinate would tell, without a picture.
[[nodiscard]] std::vector<BoardView> noisy_views(const CalibrationBoard& board, const Lens& lens,
                                                 const std::vector<Eigen::Isometry3d>& poses,
                                                 double noise_px, std::uint64_t seed);

}  // namespace gimbal::test

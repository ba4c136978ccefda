#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "drivers/synthetic/panorama.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sample/virtual_camera.hpp"

namespace gimbal {

/// Which pixels a sensor exposes at once.
enum class LineAxis : std::uint8_t { rows, columns };

[[nodiscard]] LineAxis line_axis(ReadoutDirection direction);

/// Lines of a picture: its rows, or its columns.
[[nodiscard]] int line_count(ImageSize size, LineAxis axis);

/// The ray of each pixel, worked out once. Where the lens sees nothing the ray is zero.
class RayTable {
 public:
  RayTable(const Lens& lens, ImageSize size, LineAxis axis);
  RayTable(const PinholeIntrinsics& intrinsics, ImageSize size);  ///< by rows

  [[nodiscard]] RayLine line(int line) const;
  [[nodiscard]] ImageSize size() const { return size_; }
  [[nodiscard]] LineAxis axis() const { return axis_; }

 private:
  using RayOfPixel = std::function<Eigen::Vector3d(const Eigen::Vector2d& pixel)>;
  RayTable(const RayOfPixel& ray_of_pixel, ImageSize size, LineAxis axis);

  ImageSize size_;
  LineAxis axis_;
  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> z_;
};

}  // namespace gimbal

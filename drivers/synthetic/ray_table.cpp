#include "drivers/synthetic/ray_table.hpp"

#include <cstddef>

namespace gimbal {

LineAxis line_axis(ReadoutDirection direction) {
  return reads_rows(direction) ? LineAxis::rows : LineAxis::columns;
}

int line_count(ImageSize size, LineAxis axis) {
  return axis == LineAxis::rows ? size.height : size.width;
}

RayTable::RayTable(const Lens& lens, ImageSize size, LineAxis axis)
    : RayTable(
          [&](const Eigen::Vector2d& pixel) -> Eigen::Vector3d {
            return lens.unproject(pixel).value_or(Eigen::Vector3d::Zero());
          },
          size, axis) {}

RayTable::RayTable(const PinholeIntrinsics& intrinsics, ImageSize size)
    : RayTable(
          [&](const Eigen::Vector2d& pixel) -> Eigen::Vector3d {
            return Eigen::Vector3d((pixel.x() - intrinsics.cx) / intrinsics.fx,
                                   (pixel.y() - intrinsics.cy) / intrinsics.fy, 1.0)
                .normalized();
          },
          size, LineAxis::rows) {}

RayTable::RayTable(const RayOfPixel& ray_of_pixel, ImageSize size, LineAxis axis)
    : size_(size), axis_(axis) {
  const int lines = line_count(size, axis);
  const int pixels = axis == LineAxis::rows ? size.width : size.height;
  const auto count = static_cast<std::size_t>(lines) * static_cast<std::size_t>(pixels);
  x_.reserve(count);
  y_.reserve(count);
  z_.reserve(count);
  for (int line = 0; line < lines; ++line) {
    for (int i = 0; i < pixels; ++i) {
      const Eigen::Vector2d pixel =
          axis == LineAxis::rows ? Eigen::Vector2d(i, line) : Eigen::Vector2d(line, i);
      const Eigen::Vector3d ray = ray_of_pixel(pixel);
      x_.push_back(static_cast<float>(ray.x()));
      y_.push_back(static_cast<float>(ray.y()));
      z_.push_back(static_cast<float>(ray.z()));
    }
  }
}

RayLine RayTable::line(int line) const {
  const auto length =
      static_cast<std::size_t>(axis_ == LineAxis::rows ? size_.width : size_.height);
  const std::size_t from = static_cast<std::size_t>(line) * length;
  return {std::span(x_).subspan(from, length), std::span(y_).subspan(from, length),
          std::span(z_).subspan(from, length)};
}

}  // namespace gimbal

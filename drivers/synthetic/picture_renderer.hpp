#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/synthetic/panorama.hpp"
#include "drivers/synthetic/ray_table.hpp"
#include "drivers/synthetic/sensor_noise.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sample/virtual_camera.hpp"

namespace gimbal {

/// Orientations (world from camera) at even steps through the exposure of a line: its light is
/// their mean.
using LineExposure = std::function<std::vector<Eigen::Matrix3f>(int line)>;

/// Draws a panorama as a camera with a sensor sees it, line by line, in NV12 with BT.709 colour.
class PictureRenderer {
 public:
  PictureRenderer(std::shared_ptr<const Panorama> panorama, RayTable rays,
                  const std::optional<PixelNoise>& noise);

  /// `exposure` is called from several threads, once a line.
  [[nodiscard]] VideoFrame draw(const FrameStamp& stamp, const LineExposure& exposure,
                                std::uint64_t noise_seed) const;

  [[nodiscard]] static ColorInfo color();

 private:
  std::shared_ptr<const Panorama> panorama_;
  RayTable rays_;
  std::optional<SensorNoise> noise_;
};

/// What an ideal camera sees that exposes all pixels at one instant: the truth that stabilized
/// pictures are judged by. Draw with a panorama that is fine enough for `camera`.
[[nodiscard]] VideoFrame render_global_shutter(std::shared_ptr<const Panorama> panorama,
                                               const VirtualCamera& camera, ImageSize size);

}  // namespace gimbal

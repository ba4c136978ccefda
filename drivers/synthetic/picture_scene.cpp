#include "drivers/synthetic/picture_scene.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace gimbal {
namespace {

/// How bytes stand for colour: BT.601 at full range for JPEG pictures, BT.709 at video range else.
struct Coding {
  double kr, kb;       ///< weights of red and blue in luma
  double black, luma;  ///< luma byte of black, and steps from there to white
  double chroma;       ///< steps from -1/2 to 1/2
};

/// From GStreamer's notation, range:matrix:transfer:primaries or a standard's name.
Coding coding_of(std::string_view colorimetry) {
  const bool is_full_range = colorimetry.starts_with("1:");
  const bool is_bt601 = colorimetry.find(":4:") == 1 || colorimetry == "bt601";
  Coding coding{0.2126, 0.0722, 16, 219, 224};
  if (is_bt601) coding.kr = 0.299, coding.kb = 0.114;
  if (is_full_range) coding.black = 0, coding.luma = 255, coding.chroma = 255;
  return coding;
}

/// Linear light of a signal, by BT.709's transfer function the other way round.
double light_of(double signal) {
  return signal < 0.081 ? std::max(0.0, signal / 4.5)
                        : std::pow((signal + 0.099) / 1.099, 1 / 0.45);
}

/// Folds a coordinate into [0, count - 1], mirroring at both edges.
double mirrored(double coordinate, int count) {
  const double period = 2.0 * count;
  const double folded = std::fmod(std::fmod(coordinate + 0.5, period) + period, period);
  return std::clamp((folded < count ? folded : period - folded) - 0.5, 0.0, count - 1.0);
}

}  // namespace

PictureScene::PictureScene(VideoFrame picture, double width_rad)
    : picture_(std::move(picture)), pixels_per_radian_(picture_.size.width / width_rad) {}

Eigen::Vector3d PictureScene::pixel(int x, int y) const {
  const Coding coding = coding_of(picture_.color.colorimetry);
  const ConstPlane& chroma = picture_.planes[1];
  const std::uint8_t* pair =
      chroma.data + (y / 2) * chroma.stride_bytes + std::ptrdiff_t{2} * (x / 2);
  const double luma =
      (picture_.planes[0].data[y * picture_.planes[0].stride_bytes + x] - coding.black) /
      coding.luma;
  const double blue = luma + 2 * (1 - coding.kb) * (pair[0] - 128) / coding.chroma;
  const double red = luma + 2 * (1 - coding.kr) * (pair[1] - 128) / coding.chroma;
  const double green = (luma - coding.kr * red - coding.kb * blue) / (1 - coding.kr - coding.kb);
  return {light_of(red), light_of(green), light_of(blue)};
}

Eigen::Vector3d PictureScene::color(const Eigen::Vector3d& direction_world) const {
  const ImageSize size = picture_.size;
  const double heading = std::atan2(direction_world.y(), direction_world.x());
  const double elevation = std::asin(std::clamp(direction_world.z(), -1.0, 1.0));
  const double x = mirrored(0.5 * (size.width - 1) - pixels_per_radian_ * heading, size.width);
  const double y = mirrored(0.5 * (size.height - 1) - pixels_per_radian_ * elevation, size.height);
  const int left = std::min(static_cast<int>(x), std::max(0, size.width - 2));
  const int top = std::min(static_cast<int>(y), std::max(0, size.height - 2));
  const int right = std::min(left + 1, size.width - 1);
  const int bottom = std::min(top + 1, size.height - 1);
  const double right_share = x - left;
  const double bottom_share = y - top;
  return (1 - bottom_share) *
             ((1 - right_share) * pixel(left, top) + right_share * pixel(right, top)) +
         bottom_share *
             ((1 - right_share) * pixel(left, bottom) + right_share * pixel(right, bottom));
}

}  // namespace gimbal

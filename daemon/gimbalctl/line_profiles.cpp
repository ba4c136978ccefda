#include "daemon/gimbalctl/line_profiles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace gimbal {
namespace {

/// Linear light of each value of luma (ITU-R BT.709's transfer, inverted).
std::array<double, 256> linear_light() {
  std::array<double, 256> light{};
  for (std::size_t value = 0; value < light.size(); ++value) {
    const double signal = static_cast<double>(value) / 255;
    light.at(value) = signal < 0.081 ? signal / 4.5 : std::pow((signal + 0.099) / 1.099, 1 / 0.45);
  }
  return light;
}

}  // namespace

LineProfile line_profile(const VideoFrame& frame, ReadoutDirection direction) {
  static const std::array<double, 256> light_of = linear_light();
  LineProfile profile;
  profile.time_s = seconds_since_epoch(frame.stamp.time);
  profile.light.resize(static_cast<std::size_t>(line_count(frame.size, direction)));
  for (int y = 0; y < frame.size.height; ++y) {
    const std::uint8_t* const row = frame.planes[0].data + y * frame.planes[0].stride_bytes;
    for (int x = 0; x < frame.size.width; ++x) {
      profile.light[static_cast<std::size_t>(reads_rows(direction) ? y : x)] += light_of.at(row[x]);
    }
  }
  const bool is_backwards =
      direction == ReadoutDirection::bottom_up || direction == ReadoutDirection::right_left;
  if (is_backwards) std::reverse(profile.light.begin(), profile.light.end());
  return profile;
}

}  // namespace gimbal

#include "tests/judge/row_wobble.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal::judge {
namespace {

constexpr std::size_t kLeastTracks = 6;  // in a band

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void RowWobble::add(double time_s, const Pinhole& camera, const cv::Matx33d& R_to_from,
                    const std::vector<Track>& tracks) {
  std::array<std::vector<double>, kBands> across;
  std::array<std::vector<double>, kBands> down;
  for (const Track& track : tracks) {
    const double share = (track.from.y + 0.5) / camera.size.height;
    const auto band = static_cast<std::size_t>(std::clamp(share, 0.0, 0.999) * kBands);
    const cv::Point2f left = track.to - turned(camera, R_to_from, track.from);
    across[band].push_back(left.x);
    down[band].push_back(left.y);
  }
  for (std::size_t band = 0; band < kBands; ++band) {
    if (across[band].size() < kLeastTracks) continue;
    motion_px_[band].push_back({time_s, {median(across[band]), median(down[band]), 0}});
  }
}

double RowWobble::rms_px(double cutoff_hz) const {
  std::vector<cv::Vec3d> all;
  for (const auto& band : motion_px_) {
    const std::vector<cv::Vec3d> fast = fast_part(band, cutoff_hz);
    all.insert(all.end(), fast.begin(), fast.end());
  }
  return rms_length(all);
}

}  // namespace gimbal::judge

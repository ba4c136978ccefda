#include "pipeline/sync/sighting.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gimbal {
namespace {

constexpr double kFocalStep = 1e-3;  // of its logarithm

Result<Lens> scaled_lens(LensParameters parameters, double focal_scale) {
  parameters.K(0, 0) *= focal_scale;
  parameters.K(1, 1) *= focal_scale;
  return Lens::create(std::move(parameters));
}

CameraCalibration without_times(CameraCalibration camera, SensorDuration readout) {
  camera.time_offset = SensorDuration::zero();
  camera.readout = readout;
  return camera;
}

}  // namespace

Result<SightingMaker> SightingMaker::create(const CameraCalibration& camera, double focal_scale,
                                            SensorTime zero) {
  Result<Lens> lens = scaled_lens(camera.lens, focal_scale);
  Result<Lens> longer = scaled_lens(camera.lens, focal_scale * std::exp(kFocalStep));
  Result<Lens> shorter = scaled_lens(camera.lens, focal_scale * std::exp(-kFocalStep));
  for (const Result<Lens>* made : {&lens, &longer, &shorter}) {
    if (!*made) return tl::unexpected(made->error());
  }
  return SightingMaker(*std::move(lens), *std::move(longer), *std::move(shorter), camera, zero);
}

SightingMaker::SightingMaker(Lens lens, Lens longer, Lens shorter, const CameraCalibration& camera,
                             SensorTime zero)
    : lens_(std::move(lens)),
      longer_(std::move(longer)),
      shorter_(std::move(shorter)),
      at_once_(without_times(camera, SensorDuration::zero())),
      one_second_(without_times(camera, std::chrono::seconds(1))),
      direction_(camera.readout_direction),
      zero_(zero) {}

std::optional<Sighting> SightingMaker::make(const FrameStamp& stamp,
                                            const TrackPoint& point) const {
  const Eigen::Vector2d& px = point.px;
  const auto ray = lens_.unproject(px);
  const auto longer = longer_.unproject(px);
  const auto shorter = shorter_.unproject(px);
  if (!ray || !longer || !shorter) return std::nullopt;
  const auto px_by_ray = lens_.jacobian(*ray);
  const auto px_by_longer = longer_.jacobian(*longer);
  const auto px_by_shorter = shorter_.jacobian(*shorter);
  if (!px_by_ray || !px_by_longer || !px_by_shorter) return std::nullopt;
  const double line_px = reads_rows(direction_) ? px.y() : px.x();
  const SensorTime time = at_once_.time_of_line(stamp, line_px);
  Sighting sighting;
  sighting.frame = point.frame;
  sighting.stamp_s = to_seconds(time - zero_);
  sighting.line = to_seconds(one_second_.time_of_line(stamp, line_px) - time);
  sighting.ray = *ray;
  sighting.ray_by_log_focal = (*longer - *shorter) / (2 * kFocalStep);
  sighting.px_by_ray = *px_by_ray;
  sighting.px_by_ray_by_log_focal = (*px_by_longer - *px_by_shorter) / (2 * kFocalStep);
  return sighting;
}

std::vector<SightingPair> make_pairs(const SightingMaker& maker,
                                     const std::vector<FrameStamp>& frames,
                                     const std::vector<FeatureTrack>& tracks,
                                     const PairChoice& choice) {
  std::vector<std::pair<const TrackPoint*, const TrackPoint*>> points;
  for (const FeatureTrack& track : tracks) {
    for (std::size_t i = 0; i + choice.stride < track.size(); ++i) {
      points.emplace_back(&track[i], &track[i + choice.stride]);
    }
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const auto& a, const auto& b) { return a.first->frame < b.first->frame; });
  const std::size_t count = std::min(points.size(), choice.most);
  std::vector<SightingPair> pairs;
  for (std::size_t i = 0; i < count; ++i) {
    const auto& [first, last] = points[i * points.size() / count];
    const auto from = maker.make(frames[first->frame], *first);
    const auto to = maker.make(frames[last->frame], *last);
    if (from && to) pairs.push_back({*from, *to});
  }
  return pairs;
}

}  // namespace gimbal

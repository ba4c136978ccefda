#include "pipeline/sync/gyro_integral.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pipeline/sample/rotation.hpp"
#include "pipeline/sync/median.hpp"

namespace gimbal {
namespace {

/// A hole of so many usual intervals is not bridged.
constexpr double kGapIntervals = 3.5;

/// Slope of the rate at a sample: a parabola through it and its neighbours.
Eigen::Vector3d slope_at(std::span<const GyroSample> samples, std::size_t i) {
  const std::size_t before = i == 0 ? i : i - 1;
  const std::size_t after = i + 1 == samples.size() ? i : i + 1;
  const auto slope = [&](std::size_t from, std::size_t to) -> Eigen::Vector3d {
    return (samples[to].gyro_rad_s - samples[from].gyro_rad_s) /
           to_seconds(samples[to].time - samples[from].time);
  };
  if (before == i) return slope(i, after);
  if (after == i) return slope(before, i);
  const double left_s = to_seconds(samples[i].time - samples[before].time);
  const double right_s = to_seconds(samples[after].time - samples[i].time);
  return (right_s * slope(before, i) + left_s * slope(i, after)) / (left_s + right_s);
}

}  // namespace

GyroIntegral::GyroIntegral(std::span<const GyroSample> samples, SensorTime zero,
                           const Eigen::Vector3d& bias_rad_s) {
  segments_.resize(samples.size() - 1);
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    segments_[i].begin_s = to_seconds(samples[i].time - zero);
    segments_[i].length_s = to_seconds(samples[i + 1].time - samples[i].time);
  }
  fit_rates(samples, bias_rad_s);
  integrate();
  count_gaps();
}

void GyroIntegral::fit_rates(std::span<const GyroSample> samples,
                             const Eigen::Vector3d& bias_rad_s) {
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    Segment& segment = segments_[i];
    const Eigen::Vector3d from = samples[i].gyro_rad_s - bias_rad_s;
    const Eigen::Vector3d step = samples[i + 1].gyro_rad_s - samples[i].gyro_rad_s;
    const Eigen::Vector3d slope_from = slope_at(samples, i) * segment.length_s;
    const Eigen::Vector3d slope_to = slope_at(samples, i + 1) * segment.length_s;
    segment.rate_rad_s.col(0) = from;
    segment.rate_rad_s.col(1) = slope_from;
    segment.rate_rad_s.col(2) = 3 * step - 2 * slope_from - slope_to;
    segment.rate_rad_s.col(3) = slope_from + slope_to - 2 * step;
  }
}

void GyroIntegral::integrate() {
  Eigen::Quaterniond q_start_imu = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d lever_s = Eigen::Matrix3d::Zero();
  for (Segment& segment : segments_) {
    segment.q_start_imu = q_start_imu;
    segment.bias_lever_s = lever_s;
    lever_s += segment.length_s * segment.turned(0.5).toRotationMatrix();
    q_start_imu = segment.turned(1).normalized();
  }
}

void GyroIntegral::count_gaps() {
  std::vector<double> lengths_s;
  lengths_s.reserve(segments_.size());
  for (const Segment& segment : segments_) lengths_s.push_back(segment.length_s);
  const double longest_s = kGapIntervals * median(std::move(lengths_s));
  std::size_t gaps = 0;
  for (Segment& segment : segments_) {
    segment.gaps_before = gaps;
    if (segment.length_s > longest_s) ++gaps;
  }
}

Eigen::Vector3d GyroIntegral::Segment::rate(double u) const {
  return rate_rad_s * Eigen::Vector4d(1, u, u * u, u * u * u);
}

Eigen::Quaterniond GyroIntegral::Segment::turned(double u) const {
  const double uu = u * u;
  return q_start_imu *
         quaternion_exp(length_s *
                        (rate_rad_s * Eigen::Vector4d(u, uu / 2, uu * u / 3, uu * uu / 4)));
}

const GyroIntegral::Segment* GyroIntegral::segment_at(double time_s) const {
  const auto after =
      std::upper_bound(segments_.begin(), segments_.end(), time_s,
                       [](double time, const Segment& segment) { return time < segment.begin_s; });
  if (after == segments_.begin()) return nullptr;
  const Segment& segment = *(after - 1);
  return time_s <= segment.begin_s + segment.length_s ? &segment : nullptr;
}

std::optional<GyroState> GyroIntegral::at(double time_s) const {
  const Segment* const segment = segment_at(time_s);
  if (segment == nullptr) return std::nullopt;
  const double in_s = time_s - segment->begin_s;
  const double u = in_s / segment->length_s;
  return GyroState{segment->turned(u), segment->rate(u),
                   segment->bias_lever_s + in_s * segment->turned(u / 2).toRotationMatrix()};
}

bool GyroIntegral::covers(double from_s, double to_s) const {
  const Segment* const first = segment_at(std::min(from_s, to_s));
  const Segment* const last = segment_at(std::max(from_s, to_s));
  if (first == nullptr || last == nullptr) return false;
  const bool last_is_gap = last != &segments_.back() && (last + 1)->gaps_before > last->gaps_before;
  return first->gaps_before == last->gaps_before && !last_is_gap;
}

}  // namespace gimbal

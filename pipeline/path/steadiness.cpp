#include "pipeline/path/steadiness.hpp"

#include <cmath>
#include <numbers>
#include <vector>

namespace gimbal {
namespace {

using Eigen::Vector3d;

struct Rate {
  double time_s;
  Vector3d rad_s;
};

/// In world axes, so that a turn about one axis in the world stays on one component.
std::vector<Rate> rates_of(std::span<const FramePose> poses) {
  std::vector<Rate> rates;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const SensorTime from = poses[i - 1].stamp.time;
    const SensorTime to = poses[i].stamp.time;
    const double interval_s = to_seconds(to - from);
    if (interval_s <= 0) continue;
    const Eigen::AngleAxisd turn(poses[i].q_world_camera * poses[i - 1].q_world_camera.conjugate());
    rates.push_back(
        {seconds_since_epoch(from + (to - from) / 2), turn.angle() / interval_s * turn.axis()});
  }
  return rates;
}

Vector3d low_passed(const std::vector<Rate>& rates, std::size_t center, double half_width_s) {
  Vector3d sum = Vector3d::Zero();
  double weights = 0;
  const auto add = [&](const Rate& rate) {
    const double offset_s = rate.time_s - rates[center].time_s;
    if (std::abs(offset_s) >= half_width_s) return false;
    const double weight = 0.5 * (1 + std::cos(std::numbers::pi * offset_s / half_width_s));
    sum += weight * rate.rad_s;
    weights += weight;
    return true;
  };
  for (std::size_t i = center; i < rates.size() && add(rates[i]); ++i) {
  }
  for (std::size_t i = center; i > 0 && add(rates[i - 1]); --i) {
  }
  return sum / weights;
}

}  // namespace

double rms_rate_above_rad_s(std::span<const FramePose> poses, double cutoff_hz) {
  const std::vector<Rate> rates = rates_of(poses);
  if (rates.empty()) return 0;
  double squares = 0;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    squares += (rates[i].rad_s - low_passed(rates, i, 1 / cutoff_hz)).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(rates.size()));
}

}  // namespace gimbal

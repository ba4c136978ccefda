#include "pipeline/sync/turn_miss.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

#include "pipeline/sample/rotation.hpp"
#include "pipeline/sync/cross_matrix.hpp"
#include "pipeline/sync/median.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFewestCorners = 10;
constexpr double kAgreeingShare = 0.5;
constexpr int kAbsoluteRounds = 8;
constexpr int kCauchyRounds = 4;
constexpr double kNearestMiss_px = 0.05;  // where absolute values have their kink
constexpr double kSmallestNoise_px = 0.02;
constexpr double kLossScale = 1.2;  // of the Cauchy loss, in standard deviations
constexpr double kAgreeing_rad = 3e-3;

/// A corner where the gyroscope takes it, and how its miss depends on a further turn.
struct Taken {
  Eigen::Vector2d miss_px;
  Eigen::Matrix<double, 2, 3> px_by_turn;
  Eigen::Vector3d by_offset_rad_s;
};

std::optional<Taken> taken(const SightingPair& pair, const FeltTurning& felt) {
  const auto from =
      felt.gyro.at(pair.from.stamp_s + felt.offset_s + felt.readout_s * pair.from.line);
  const auto to = felt.gyro.at(pair.to.stamp_s + felt.offset_s + felt.readout_s * pair.to.line);
  if (!from || !to) return std::nullopt;
  const Eigen::Matrix3d R_to_from =
      felt.R_camera_imu * (to->q_start_imu.conjugate() * from->q_start_imu).toRotationMatrix() *
      felt.R_camera_imu.transpose();
  const Eigen::Vector3d ray = R_to_from * pair.from.ray;
  Taken corner;
  corner.miss_px = -(pair.to.px_by_ray * (ray / ray.dot(pair.to.ray)));
  corner.px_by_turn = -pair.to.px_by_ray * cross_matrix(ray);
  corner.by_offset_rad_s =
      R_to_from * felt.R_camera_imu * from->rate_rad_s - felt.R_camera_imu * to->rate_rad_s;
  return corner;
}

double miss_px(const Taken& corner, const Eigen::Vector3d& turn_rad) {
  return (corner.miss_px - corner.px_by_turn * turn_rad).norm();
}

double noise_px(const std::vector<Taken>& corners, const Eigen::Vector3d& turn_rad) {
  std::vector<double> misses;
  misses.reserve(corners.size());
  for (const Taken& corner : corners) misses.push_back(miss_px(corner, turn_rad));
  return std::max(kSmallestNoise_px, coordinate_sigma(std::move(misses)));
}

struct Step {
  Eigen::Vector3d turn_rad;
  Eigen::Matrix3d normal;
};

template <typename Weight>
Step weighted_turn(const std::vector<Taken>& corners, const Weight& weight_of) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-6;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const Taken& corner : corners) {
    const double weight = weight_of(corner);
    normal += weight * corner.px_by_turn.transpose() * corner.px_by_turn;
    gradient += weight * corner.px_by_turn.transpose() * corner.miss_px;
  }
  return {normal.ldlt().solve(gradient), normal};
}

/// Sums of distances first: what most corners want, wherever that is; then Cauchy's loss about it.
Step common_turn(const std::vector<Taken>& corners) {
  Step step{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()};
  for (int round = 0; round < kAbsoluteRounds; ++round) {
    step = weighted_turn(corners, [turn = step.turn_rad](const Taken& corner) {
      return 1 / std::max(kNearestMiss_px, miss_px(corner, turn));
    });
  }
  for (int round = 0; round < kCauchyRounds; ++round) {
    const double scale_px = kLossScale * noise_px(corners, step.turn_rad);
    step = weighted_turn(corners, [turn = step.turn_rad, scale_px](const Taken& corner) {
      const double share = 1 + std::pow(miss_px(corner, turn) / scale_px, 2);
      return 1 / (share * share);
    });
  }
  return step;
}

bool do_agree(const std::vector<Taken>& corners, const Eigen::Vector3d& turn_rad) {
  const auto agreeing = std::ranges::count_if(corners, [&](const Taken& corner) {
    const double px_by_rad = corner.px_by_turn.norm() / std::numbers::sqrt2;
    return miss_px(corner, turn_rad) < kAgreeing_rad * px_by_rad;
  });
  return static_cast<double>(agreeing) >= kAgreeingShare * static_cast<double>(corners.size());
}

double middle_s(std::span<const SightingPair> pairs, const Sighting SightingPair::*end,
                double readout_s) {
  double sum_s = 0;
  for (const SightingPair& pair : pairs) {
    sum_s += (pair.*end).stamp_s + readout_s * (pair.*end).line;
  }
  return sum_s / static_cast<double>(pairs.size());
}

}  // namespace

std::optional<TurnMiss> turn_miss(std::span<const SightingPair> corners, const FeltTurning& felt) {
  std::vector<Taken> where;
  TurnMiss result;
  result.by_offset_rad_s.setZero();
  for (const SightingPair& pair : corners) {
    const auto corner = taken(pair, felt);
    if (!corner) return std::nullopt;
    where.push_back(*corner);
    result.by_offset_rad_s += corner->by_offset_rad_s / static_cast<double>(corners.size());
  }
  if (where.size() < kFewestCorners) return std::nullopt;
  const Step common = common_turn(where);
  if (!do_agree(where, common.turn_rad)) return std::nullopt;
  const double noise = noise_px(where, common.turn_rad);
  result.miss_rad = common.turn_rad;
  result.covariance_rad2 = noise * noise * common.normal.inverse();
  result.from_s = middle_s(corners, &SightingPair::from, felt.readout_s);
  result.to_s = middle_s(corners, &SightingPair::to, felt.readout_s);
  result.by_bias_s = (result.to_s - result.from_s) * felt.R_camera_imu;
  const auto from = felt.gyro.at(result.from_s + felt.offset_s);
  const auto to = felt.gyro.at(result.to_s + felt.offset_s);
  const Eigen::Quaterniond q_camera_imu(felt.R_camera_imu);
  result.q_to_from = quaternion_exp(result.miss_rad) * q_camera_imu * to->q_start_imu.conjugate() *
                     from->q_start_imu * q_camera_imu.conjugate();
  return result;
}

}  // namespace gimbal

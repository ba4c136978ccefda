#include "pipeline/sync/visual_turn.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "pipeline/sample/rotation.hpp"
#include "pipeline/sync/cross_matrix.hpp"
#include "pipeline/sync/median.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFewestCorners = 12;
constexpr int kRounds = 10;
constexpr double kTightest_px = 1.5;  // rows alone part corners by as much
constexpr double kAgreeing_px = 6;    // ... and in a quick move by that
constexpr double kAgreeingShare = .4;

/// Where a corner came to lie, less where it should have with the camera turned by `turn_rad`, px.
Eigen::Vector2d miss_px(const SightingPair& pair, const Eigen::Quaterniond& q_to_from) {
  const Eigen::Vector3d ray = q_to_from * pair.from.ray;
  return pair.to.px_by_ray * (ray / ray.dot(pair.to.ray));
}

double median_miss_px(std::span<const SightingPair> pairs, const Eigen::Quaterniond& q_to_from) {
  std::vector<double> misses;
  misses.reserve(pairs.size());
  for (const SightingPair& pair : pairs) misses.push_back(miss_px(pair, q_to_from).norm());
  return median(std::move(misses));
}

/// One step of least squares, in which what misses by more than `scale_px` counts ever less
/// (Geman and McClure).
Eigen::Quaterniond improved(std::span<const SightingPair> pairs,
                            const Eigen::Quaterniond& q_to_from, double scale_px) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() * 1e-6;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  for (const SightingPair& pair : pairs) {
    const Eigen::Vector2d miss = miss_px(pair, q_to_from);
    const double share = 1 + miss.squaredNorm() / (scale_px * scale_px);
    const double weight = 1 / (share * share);
    const Eigen::Matrix<double, 2, 3> by_turn =
        -pair.to.px_by_ray * cross_matrix(q_to_from * pair.from.ray);
    normal += weight * by_turn.transpose() * by_turn;
    gradient += weight * by_turn.transpose() * miss;
  }
  const Eigen::Vector3d step = normal.ldlt().solve(gradient);
  return (quaternion_exp(-step) * q_to_from).normalized();
}

/// Nothing if no turn suits enough of the corners.
std::optional<Eigen::Quaterniond> common_turn(std::span<const SightingPair> pairs) {
  Eigen::Quaterniond q_to_from = Eigen::Quaterniond::Identity();
  for (int round = 0; round < kRounds; ++round) {
    const double scale_px = std::max(kTightest_px, 1.5 * median_miss_px(pairs, q_to_from));
    q_to_from = improved(pairs, q_to_from, scale_px);
  }
  const auto agreeing = std::count_if(pairs.begin(), pairs.end(), [&](const SightingPair& pair) {
    return miss_px(pair, q_to_from).norm() < kAgreeing_px;
  });
  if (static_cast<double>(agreeing) < kAgreeingShare * static_cast<double>(pairs.size())) {
    return std::nullopt;
  }
  return q_to_from;
}

}  // namespace

std::vector<VisualTurn> visual_turns(const std::vector<SightingPair>& pairs, double readout_s) {
  std::vector<VisualTurn> turns;
  for (std::size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
    while (end < pairs.size() && pairs[end].from.frame == pairs[begin].from.frame) ++end;
    const std::span<const SightingPair> of_frame(&pairs[begin], end - begin);
    if (of_frame.size() < kFewestCorners) continue;
    const auto q_to_from = common_turn(of_frame);
    if (!q_to_from) continue;
    const SightingPair& one = of_frame.front();
    // Any corner of the frame tells the stamp; its middle line is half a readout after the first.
    const double to_middle_s = readout_s * (0.5 + (one.from.line < 0 ? -1.0 : 0.0));
    const double length_s = one.to.stamp_s - one.from.stamp_s;
    turns.push_back({one.from.stamp_s + to_middle_s, one.to.stamp_s + to_middle_s,
                     -quaternion_log(*q_to_from) / length_s});
  }
  return turns;
}

}  // namespace gimbal

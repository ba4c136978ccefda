#include "pipeline/sync/offset_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

constexpr double kStep_s = 4e-3;  // a hand shakes at 12 Hz at most
constexpr double kFineReach_s = 6e-3;
constexpr double kFineStep_s = 0.5e-3;
constexpr std::size_t kFewestTurns = 9;
constexpr double kBestToUsual = 0.5;
constexpr double kBestToRival = 0.75;
constexpr double kRivalAway_s = 0.04;

struct Cost {
  double offset_s = 0;
  double mean_rad = 0;
};

/// The turns whose surroundings the log covers, and how badly an offset explains them.
class Explained {
 public:
  Explained(std::span<const TurnMiss> seen, const GyroIntegral& gyro,
            const Eigen::Matrix3d& R_camera_imu, double middle_s, double reach_s)
      : gyro_(gyro), q_camera_imu_(R_camera_imu) {
    for (const TurnMiss& turn : seen) {
      if (gyro.covers(turn.from_s + middle_s - reach_s, turn.to_s + middle_s + reach_s)) {
        turns_.push_back(&turn);
      }
    }
  }

  [[nodiscard]] std::size_t count() const { return turns_.size(); }

  /// Mean distance of the misses from their mean, which is the gyroscope's bias.
  [[nodiscard]] Cost cost_at(double offset_s) const {
    std::vector<Eigen::Vector3d> misses_rad;
    const auto share = 1 / static_cast<double>(turns_.size());
    Eigen::Vector3d mean_rad = Eigen::Vector3d::Zero();
    for (const TurnMiss* turn : turns_) {
      misses_rad.push_back(quaternion_log(turn->q_to_from * felt(*turn, offset_s).conjugate()));
      mean_rad += share * misses_rad.back();
    }
    double distance_rad = 0;
    for (const Eigen::Vector3d& miss_rad : misses_rad) {
      distance_rad += share * (miss_rad - mean_rad).norm();
    }
    return {offset_s, distance_rad};
  }

 private:
  [[nodiscard]] Eigen::Quaterniond felt(const TurnMiss& turn, double offset_s) const {
    return q_camera_imu_ *
           (gyro_.at(turn.to_s + offset_s)->q_start_imu.conjugate() *
            gyro_.at(turn.from_s + offset_s)->q_start_imu) *
           q_camera_imu_.conjugate();
  }

  const GyroIntegral& gyro_;
  Eigen::Quaterniond q_camera_imu_;
  std::vector<const TurnMiss*> turns_;
};

std::vector<Cost> costs_about(const Explained& explained, double middle_s, double reach_s,
                              double step_s) {
  std::vector<Cost> costs;
  const auto steps = static_cast<int>(std::lround(reach_s / step_s));
  for (int step = -steps; step <= steps; ++step) {
    costs.push_back(explained.cost_at(middle_s + step * step_s));
  }
  return costs;
}

Cost best_of(const std::vector<Cost>& costs) {
  return *std::ranges::min_element(costs, {}, &Cost::mean_rad);
}

bool is_clear(const Cost& best, const std::vector<Cost>& costs) {
  std::vector<double> away_rad;
  for (const Cost& cost : costs) {
    if (std::abs(cost.offset_s - best.offset_s) > kRivalAway_s) away_rad.push_back(cost.mean_rad);
  }
  std::ranges::sort(away_rad);
  return best.mean_rad < kBestToRival * away_rad.front() &&
         best.mean_rad < kBestToUsual * away_rad[away_rad.size() / 2];
}

}  // namespace

std::optional<double> find_offset(std::span<const TurnMiss> seen, const GyroIntegral& gyro,
                                  const Eigen::Matrix3d& R_camera_imu, double middle_s) {
  const Explained explained(seen, gyro, R_camera_imu, middle_s, kOffsetReach_s);
  if (explained.count() < kFewestTurns) return std::nullopt;
  const std::vector<Cost> costs = costs_about(explained, middle_s, kOffsetReach_s, kStep_s);
  const Cost best = best_of(costs);
  if (!is_clear(best, costs)) return std::nullopt;
  return best.offset_s;
}

double improve_offset(std::span<const TurnMiss> seen, const GyroIntegral& gyro,
                      const Eigen::Matrix3d& R_camera_imu, double offset_s) {
  const Explained explained(seen, gyro, R_camera_imu, offset_s, kFineReach_s);
  if (explained.count() == 0) return offset_s;
  return best_of(costs_about(explained, offset_s, kFineReach_s, kFineStep_s)).offset_s;
}

}  // namespace gimbal

#pragma once

#include <Eigen/Core>

namespace gimbal {

struct SteadinessParameters {
  double block_s = 0.25;  ///< what swings faster cancels
  double memory_s = 1;
  double first_s = 0.75;  ///< before so much was seen, nothing is said
};

/// How steady a rate is once vibration has cancelled, by its Allan variance over blocks: half of
/// the mean square change from one block's mean to the next. A value: copy it to save it.
class Steadiness {
 public:
  explicit Steadiness(const SteadinessParameters& parameters) : parameters_(parameters) {}

  void add(const Eigen::Vector3d& turn_rad, double interval_s);

  /// Two-sided density of the rate about what it is in the mean, rad²/s, all axes together.
  /// Infinite while too little was seen. An unsteady block counts at once and is forgotten slowly.
  [[nodiscard]] double rate_density_rad2_s() const;

 private:
  void end_block();

  SteadinessParameters parameters_;
  Eigen::Vector3d turn_rad_ = Eigen::Vector3d::Zero();  ///< in this block
  double interval_s_ = 0;
  Eigen::Vector3d last_rate_rad_s_ = Eigen::Vector3d::Zero();
  double seen_s_ = 0;  ///< in blocks that ended
  double allan_variance_rad2_s2_ = 0;
};

}  // namespace gimbal

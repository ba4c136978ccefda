#include "pipeline/estimator/steadiness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gimbal {

void Steadiness::add(const Eigen::Vector3d& turn_rad, double interval_s) {
  turn_rad_ += turn_rad;
  interval_s_ += interval_s;
  if (interval_s_ >= parameters_.block_s) end_block();
}

void Steadiness::end_block() {
  const Eigen::Vector3d rate = turn_rad_ / interval_s_;
  if (seen_s_ > 0) {
    const double seen = (rate - last_rate_rad_s_).squaredNorm() / 2;
    // The first few have equal shares.
    const double share =
        std::max(-std::expm1(-interval_s_ / parameters_.memory_s), interval_s_ / seen_s_);
    allan_variance_rad2_s2_ += std::min(share, 1.0) * (seen - allan_variance_rad2_s2_);
    allan_variance_rad2_s2_ = std::max(allan_variance_rad2_s2_, seen);
  }
  seen_s_ += interval_s_;
  last_rate_rad_s_ = rate;
  turn_rad_.setZero();
  interval_s_ = 0;
}

double Steadiness::rate_density_rad2_s() const {
  if (seen_s_ < parameters_.first_s) return std::numeric_limits<double>::infinity();
  return parameters_.block_s * allan_variance_rad2_s2_;
}

}  // namespace gimbal

#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "pipeline/sync/turn_miss.hpp"

namespace gimbal {

/// Whether a miss was believed.
enum class Verdict : std::uint8_t { agrees, disagrees };

/// Kalman filter of what makes turns that are felt differ from those that are seen: the time
/// offset, its drift, the gyroscope's bias, and what a hand seems to turn by when it moves the
/// camera aside. That lasts for a few frames, so that the pairs of a burst tell it apart.
///
/// How much the hand sways is learnt from the misses' median, so that the uncertainty is honest.
class OffsetFilter {
 public:
  /// Of the offset, before anything was seen.
  OffsetFilter(double offset_s, double sigma_s);

  [[nodiscard]] double offset_s() const { return state_[kOffset]; }
  [[nodiscard]] double drift() const { return state_[kDrift]; }  ///< seconds a second
  [[nodiscard]] double sigma_s() const;
  [[nodiscard]] Eigen::Vector3d bias_rad_s() const { return state_.segment<3>(kBias); }

  /// What is known after so long without news.
  void predict(double elapsed_s);

  /// `miss` is about this filter's offset and bias. One that disagrees changes nothing.
  [[nodiscard]] Verdict update(const TurnMiss& miss);

  /// Whether the last misses say, all together, that the offset is not what it was.
  [[nodiscard]] bool has_jumped() const;

  /// The offset is another one from now on; drift and bias stay as they are known.
  void restart(double offset_s, double sigma_s);

 private:
  static constexpr int kOffset = 0;
  static constexpr int kDrift = 1;
  static constexpr int kBias = 2;
  static constexpr int kSway = 5;
  static constexpr int kSize = 8;
  using State = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Zero();
  // What the last misses say of a further offset, as the normal equation of one unknown.
  double jump_gradient_ = 0;
  double jump_normal_ = 0;
  double scatter_ = 4;  ///< of the sway, in units of its usual variance
};

}  // namespace gimbal

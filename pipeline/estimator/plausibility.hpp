#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "pipeline/estimator/lost_axes.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// Whether samples can be what they claim: rad/s and m/s², measured on every axis.
enum class Plausibility : std::uint8_t {
  plausible,  ///< or too little seen to tell
  gyro_in_degrees,
  gyro_stuck,
  accel_in_g,
  accel_too_small,
  accel_too_large,
  accel_stuck,
};

/// One line for a person: what is odd and what to do. Empty if nothing is.
[[nodiscard]] std::string_view describe(Plausibility plausibility);

/// A camera that is held, carried or flown feels about 1 g most of the time, and turns at some
/// rad/s at most. Each sample votes for what it looks like, as long as it lasts; what most of some
/// seconds vote for is the verdict. So a few bad samples decide nothing, however large they are. A
/// unit does not mend itself: once odd, the verdict stays.
class PlausibilityCheck {
 public:
  /// The sample as it came, of whatever size, and what is known of the axes.
  void update(const ImuSample& sample, const AxisLosses& gyro, const AxisLosses& accel);

  [[nodiscard]] Plausibility verdict() const { return verdict_; }

 private:
  static constexpr std::size_t kOutcomes = 7;
  struct Poll {
    std::array<double, kOutcomes> votes_s{};
    double total_s = 0;
  };
  void vote(Poll& poll, Plausibility looks, double interval_s);

  Poll gyro_;
  Poll accel_;
  std::optional<SensorTime> last_;
  Plausibility verdict_ = Plausibility::plausible;
};

}  // namespace gimbal

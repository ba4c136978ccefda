#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

namespace gimbal {

/// Whether samples can be what they claim: rad/s and m/s².
enum class Plausibility : std::uint8_t {
  plausible,  ///< or too little seen to tell
  accel_in_g,
  accel_too_small,
  accel_too_large,
  gyro_in_degrees,
};

/// One line for a person: what is odd and what to do. Empty if nothing is.
[[nodiscard]] std::string_view describe(Plausibility plausibility);

/// Judges by averages over all that was seen: a camera that is held, carried or flown feels about
/// 1 g on average, and turns at some rad/s at most.
class PlausibilityCheck {
 public:
  void update(const Eigen::Vector3d& gyro_rad_s, const std::optional<Eigen::Vector3d>& accel_m_s2,
              double interval_s);

  [[nodiscard]] Plausibility verdict() const;

 private:
  double gyro_s_ = 0;
  double accel_s_ = 0;
  double gyro_sum_rad_ = 0;   ///< of |rate| dt
  double accel_sum_m_s_ = 0;  ///< of |force| dt
};

}  // namespace gimbal

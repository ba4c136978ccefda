#pragma once

#include <Eigen/Core>
#include <optional>

namespace gimbal {

struct MotorVibrationParameters {
  double accel_m_s2 = 1;  ///< root mean square from sample to sample; hands show 0.2
  double memory_s = 0.3;
  double hand_rate_rad_s = 1.5;  ///< machines that carry a camera turn slower
  double rate_memory_s = 0.5;
};

/// Whether a machine carries the device: its motors shake the accelerometer from one sample to the
/// next, as a hand cannot. A hand may hold what vibrates, but turns it faster. A value: copy it to
/// save it.
class MotorVibration {
 public:
  explicit MotorVibration(const MotorVibrationParameters& parameters) : parameters_(parameters) {}

  void add(const Eigen::Vector3d& gyro_rad_s, const std::optional<Eigen::Vector3d>& accel_m_s2,
           double interval_s);

  /// 0 for a hand to 1 for a machine.
  [[nodiscard]] double machine_share() const;

 private:
  MotorVibrationParameters parameters_;
  std::optional<Eigen::Vector3d> last_accel_m_s2_;
  std::optional<Eigen::Vector3d> last_change_m_s2_;
  double accel_mean_square_m2_s4_ = 0;
  std::optional<double> rate_mean_square_rad2_s2_;
};

}  // namespace gimbal

#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pipeline/estimator/estimator.hpp"
#include "pipeline/estimator/thesis_model.hpp"

namespace gimbal {

/// Which rate turns the camera between two samples.
enum class RateHold : std::uint8_t {
  previous,  ///< the earlier sample's, as the thesis has it: exact for rates held between samples
  mean,      ///< the mean of both: second order for rates that are sampled from smooth motion
};

/// The two noise densities matter by their ratio only: the tilt follows the accelerometer with a
/// time constant of accel_noise / (g gyro_noise). The defaults make it 10 s, about the shortest
/// that, on harsh handheld motion, keeps the accelerometer's part in the turn over 30 ms, a frame's
/// readout, below 0.02 degrees. Shorter ones give a better tilt, above all with gyroscopes of large
/// bias.
struct ThesisEkfParameters {
  Discretization discretization = Discretization::exact;
  RateHold rate_hold = RateHold::mean;
  /// Noise density of the gyroscope; (2.11) holds the noise over an interval T, so Q = density²/T.
  /// Includes what the model leaves out: bias and scale errors.
  double gyro_noise_rad_s_rthz = 0.001;
  /// Noise density of the accelerometer, R = density²/T. Acceleration of the device, which the
  /// thesis leaves out, is noise here, so that it is far above the sensor's own.
  double accel_noise_m_s2_rthz = 0.1;
  /// Standard deviation of the tilt that one accelerometer sample gives at the start. Heading
  /// starts without any: left uncertain, it would take part in every correction of the tilt.
  double initial_tilt_sigma_rad = 0.1;
  /// After a longer pause between samples nothing is known of the turn meanwhile.
  SensorDuration max_gap = std::chrono::milliseconds(500);
};

/// What an estimator met that it could not use.
struct ThesisEkfCounts {
  std::size_t skipped_gyro = 0;   ///< not finite, beyond any sensor's range, or not later
  std::size_t skipped_accel = 0;  ///< not finite or beyond any sensor's range
  std::size_t gaps = 0;           ///< longer than max_gap
};

/// Algorithm 1 of the thesis (2.2.5): an extended Kalman filter whose state is the quaternion
/// q_world_imu. Time update with the gyroscope, measurement update with the accelerometer, each
/// followed by normalisation. There is no magnetometer: heading starts at an arbitrary value, and
/// without an accelerometer the world is the IMU's frame at the first sample.
///
/// The first accelerometer sample sets the tilt, turning the world under the camera if samples
/// without one came before. Samples that cannot be used are skipped and counted; the answer for
/// their instant is then predicted with the last rate. After a gap the orientation is held and its
/// covariance starts again, so that the accelerometer soon puts the tilt right.
class ThesisEkf final : public Estimator {
 public:
  explicit ThesisEkf(const ThesisEkfParameters& parameters = {});

  Attitude update(const ImuSample& sample) override;

  /// Of the quaternion (q0, q1, q2, q3): 4x4, symmetric, positive semidefinite.
  [[nodiscard]] const Eigen::Matrix4d& covariance() const { return P_; }
  [[nodiscard]] const ThesisEkfCounts& counts() const { return counts_; }

 private:
  struct TimedRate {
    SensorTime time;
    Eigen::Vector3d rate_rad_s;
  };

  void advance_to(const ImuSample& sample);
  void time_update(const Eigen::Vector3d& rate_rad_s, SensorDuration interval);
  void use_accel(const Eigen::Vector3d& accel_m_s2, SensorDuration interval);
  void set_tilt(const Eigen::Vector3d& accel_m_s2);
  void measurement_update(const Eigen::Vector3d& accel_m_s2, SensorDuration interval);
  void restart_covariance();
  [[nodiscard]] Attitude predict(SensorTime time) const;

  ThesisEkfParameters parameters_;
  ThesisEkfCounts counts_;
  QuaternionVector q_{1, 0, 0, 0};
  Eigen::Matrix4d P_;
  bool tilt_is_known_ = false;
  std::optional<TimedRate> last_;
};

}  // namespace gimbal

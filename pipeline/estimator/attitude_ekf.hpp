#pragma once

#include <Eigen/Core>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include "pipeline/estimator/error_state_filter.hpp"
#include "pipeline/estimator/estimator.hpp"
#include "pipeline/estimator/lost_axes.hpp"
#include "pipeline/estimator/motor_vibration.hpp"
#include "pipeline/estimator/plausibility.hpp"
#include "pipeline/estimator/steadiness.hpp"
#include "pipeline/estimator/tilt_alignment.hpp"
#include "pipeline/estimator/tilt_watch.hpp"

namespace gimbal {

/// A gyroscope's bias and how well it is known, for example from the run before.
struct GyroBias {
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();
  /// An axis each. Phones show up to 5.5 deg/s.
  Eigen::Vector3d sigma_rad_s = Eigen::Vector3d::Constant(2.7 * std::numbers::pi / 180);
};

/// One set for all devices. Noise densities are an axis' and two-sided: a density of n² in the mean
/// over T has the variance n²/T, and its integral grows by n² a second.
struct AttitudeEkfParameters {
  // What sensors do, by their data sheets.
  GyroBias gyro_bias;
  /// From the run before (AttitudeEkf::gyro_bias). Better than knowing nothing, but a sensor that
  /// has cooled or warmed since has another bias than it had.
  std::optional<GyroBias> remembered_bias;
  double bias_change_between_runs_rad_s = 0.6 * std::numbers::pi / 180;  ///< sigma
  double gyro_noise_rad_s_rthz = 0.0011;
  double gyro_bias_walk_rad_s_rts = 0.0003;
  double gyro_scale_sigma = 0.005;
  double accel_noise_m_s2_rthz = 0.04;
  double accel_bias_sigma_m_s2 = 0.035;
  double accel_bias_walk_m_s2_rts = 0.0002;
  double accel_scale_sigma = 0.02;
  /// What no state explains (axes that are not square, scales that are not linear): a share of
  /// the rate and of the acceleration beside gravity, as a noise density.
  double gyro_misfit_rts = 0.002;
  double accel_misfit_rts = 0.025;

  // What hands and vehicles do. Velocity stays near zero, as a white measurement of zero whose
  // density is twice its variance times its correlation time; faster shakes move faster.
  double velocity_density_m2_s = 0.4;
  double velocity_density_by_accel_s3 = 0.03;  ///< times the recent mean square acceleration
  /// What flies moves further: residuals of the velocity that stay on one side for long show its
  /// density. So much is taken for granted until it is seen: 1 m/s for a second, as one walks.
  double velocity_mean_s = 1;
  double velocity_memory_s = 5;
  double start_velocity_density_m2_s = 2;
  /// A start in flight: what motors shake may move as fast as this, an axis, unless the rate shows
  /// that it is parked; and its density over the square of that, twice the correlation time.
  MotorVibrationParameters vibration;
  double machine_velocity_m_s = 2.5;
  double parked_density_rad2_s = 5e-5;
  double machine_density_s = 10;
  /// Acceleration beside gravity is bounded too, which brings a tilt that is badly known (at the
  /// start, after gaps and lost axes) near in no time. Later its correlation in time would mislead.
  double accel_density_m2_s3 = 0.06;
  double accel_density_by_accel_s = 0.2;
  double accel_density_by_velocity_s2 = 0.4;  ///< of what the velocity's is above that of a walk
  double coarse_tilt_sigma_rad = 0.05;        ///< below this the velocity alone decides
  double accel_memory_s = 0.8;
  /// Turns come and go: the gyroscope's mean shows its bias, the better the steadier the device is.
  /// Density of the rate as a measurement of the bias over the rate's recent variance. A mean that
  /// is further from the bias than a hand that holds still makes it is rather a pan, and counts
  /// less.
  double rate_density_s = 0.8;
  double rate_memory_s = 0.08;
  double steadiest_rate_rad_s = 0.004;
  double hold_rate_rad_s = 0.012;
  /// On a platform that vibrates at rest, the rate over blocks is steadier than that: the mean of
  /// some seconds then shows the bias. Density of that mean over what its few blocks show.
  SteadinessParameters steadiness;
  double steady_doubt = 10;
  double steadiest_density_rad2_s = 3.2e-6;
  double largest_bias_rad_s = 10 * std::numbers::pi / 180;  ///< faster is a pan, no bias

  // Start, gaps, lost axes, a tilt that is wrong.
  TiltAlignmentParameters alignment;
  TiltWatchParameters tilt_watch;
  double start_rate_walk_rad_s_rts = 30;  ///< how fast rates change, until it is known
  double rate_walk_memory_s = 0.5;
  double lost_axis_density_rad_s_rthz = 1.3;
  /// A rate beyond the range lies so much beyond it on average, as a share of the range: of rates
  /// that are normal with a sigma of 0.6 ranges.
  double clipped_excess = 0.25;
  double unseen_accel_m_s2 = 2;  ///< acceleration while no accelerometer shows it
  double gap_intervals = 2.5;    ///< so many usual intervals without a sample are a gap
  SensorDuration longest_bridge = std::chrono::seconds(1);  ///< longer gaps start the tilt anew

  /// The covariance is carried in steps of at least this length.
  SensorDuration step = std::chrono::milliseconds(20);
  LostAxesParameters lost_gyro_axes = kLostGyroAxes;
  LostAxesParameters lost_accel_axes = kLostAccelAxes;
};

/// What an estimator met that was not as it should be.
struct AttitudeEkfCounts {
  std::size_t skipped_gyro = 0;  ///< not finite, beyond any sensor's range, not later, or
                                 ///< alone far ahead
  std::size_t skipped_accel =
      0;  ///< not finite, beyond any sensor's range, an axis clipped or stuck
  std::size_t gaps = 0;
  std::size_t restarts = 0;      ///< gaps beyond the longest bridge
  std::size_t realignments = 0;  ///< of a tilt that was wrong
  std::size_t lost_samples = 0;  ///< with an axis clipped or stuck
};

/// Everything that the filter knows. A value: saved and restored by copying, to the bit.
struct AttitudeEkfState {
  struct LastSample {
    SensorTime time;
    Eigen::Vector3d gyro_rad_s;
    std::optional<Eigen::Vector3d> accel_m_s2;
  };
  std::optional<LastSample> last;
  std::optional<SensorTime> leap;  ///< a stamp far ahead that nothing bears out yet
  bool tilt_is_known = false;
  TiltAlignment alignment{TiltAlignmentParameters{}};  ///< until then
  TiltWatch tilt_watch{TiltWatchParameters{}};         ///< from then on
  ErrorStateFilter filter;
  double heading_held_back_rad = 0;            ///< of the filter's corrections, see AttitudeEkf ...
  double heading_held_back_variance_rad2 = 0;  ///< ... and what they could be expected to be
  double usual_interval_s = 0;
  Eigen::Vector3d step_rate_rad_s = Eigen::Vector3d::Zero();  ///< at the end of the last step
  double rate_walk_rad2_s3 = 0;  ///< how fast the rate changes: mean of |change|²/interval of steps
  double accel_mean_square_m2_s4 = 0;                           ///< beside gravity
  Eigen::Vector3d velocity_mean_m_s = Eigen::Vector3d::Zero();  ///< recent, before its bound
  double seen_velocity_density_m2_s = 0;
  MotorVibration vibration{MotorVibrationParameters{}};
  Eigen::Vector3d rate_mean_rad_s = Eigen::Vector3d::Zero();
  double rate_variance_rad2_s2 = 0;
  Steadiness steadiness{SteadinessParameters{}};
  LostAxes lost_gyro_axes{kLostGyroAxes};
  LostAxes lost_accel_axes{kLostAccelAxes};
  PlausibilityCheck plausibility;
  AttitudeEkfCounts counts;
  FilterStep step;
  std::size_t step_count = 0;
};

/// Error-state Kalman filter for a camera that is held, worn, carried or flown, without a
/// magnetometer. States: attitude, gyroscope bias and scale, velocity, accelerometer bias and
/// scale.
///
/// Gravity comes in through the velocity: specific force less gravity, integrated in world axes, is
/// the device's velocity plus what a wrong tilt adds; a device that stays where it is or walks has
/// a bounded velocity, so that what grows is tilt error. Short accelerations cancel by themselves.
/// There is no rest detector: bias is measured all the time, and the recent variance of the rate
/// says how well, or how little its mean changes once the vibration of motors has cancelled.
///
/// Heading is never observed. What a better bias says about past heading is kept in the filter but
/// not shown: the answers' heading has no steps, only the rate's integral. Their covariance counts
/// what was held back.
///
/// At the start, and after a gap that is too long, the tilt comes from the forces of the first
/// moments alone (TiltAlignment): only then may errors be taken for small. Until then the filter
/// goes on in axes that the gyroscope holds still, and the answers are turned upright. A tilt that
/// is wrong all the same, and believed, is noticed within seconds (TiltWatch) and found anew.
///
/// A sample is the rate at its stamp's instant, and between samples, over a gap too, the rate goes
/// straight from one to the next. Neither allocates nor throws.
class AttitudeEkf final : public Estimator {
 public:
  explicit AttitudeEkf(const AttitudeEkfParameters& parameters = {});

  /// A sample that cannot be used is skipped and counted; the answer is then a prediction.
  Attitude update(const ImuSample& sample) override;

  /// At the last sample `exact`; later with the last rate, `predicted`. Before the first sample,
  /// and for instants before the last one, the last orientation, `predicted`.
  [[nodiscard]] AttitudeEstimate predict(SensorTime time) const;

  /// To be kept for the next run, as AttitudeEkfParameters::remembered_bias.
  [[nodiscard]] GyroBias gyro_bias() const;

  /// From the axes of the filter's mean to upright ones: the identity once the tilt is known.
  [[nodiscard]] Eigen::Quaterniond turn_upright() const;

  [[nodiscard]] Plausibility plausibility() const { return state_.plausibility.verdict(); }
  [[nodiscard]] const AttitudeEkfCounts& counts() const { return state_.counts; }

  [[nodiscard]] const AttitudeEkfState& state() const { return state_; }
  void restore(const AttitudeEkfState& state) { state_ = state; }

 private:
  [[nodiscard]] bool leaps(SensorTime time);
  [[nodiscard]] bool accel_is_usable(const ImuSample& sample);
  void start(const ImuSample& sample);
  void continue_with(const ImuSample& sample);
  void bridge_or_advance(const ImuSample& sample, double interval_s);
  [[nodiscard]] IntervalNoise noise_of(const Eigen::Vector3d& gyro_rad_s,
                                       const std::optional<Eigen::Vector3d>& accel_m_s2,
                                       double interval_s) const;
  void account_for_lost_axes(const ImuSample& sample, double interval_s,
                             Eigen::Vector3d& gyro_rad_s, IntervalNoise& noise);
  void learn_intervals(double interval_s);
  void learn_rate_walk(const ImuSample& sample, double interval_s);
  void start_alignment(const ImuSample& sample);
  void restart_tilt(const ImuSample& sample);
  void realign(SensorTime time);
  void become_upright();
  void begin_step(SensorTime time);
  void begin_anew(SensorTime time);
  void end_step();
  void close_step(SensorTime time);
  void bound_motion(const ErrorStateFilter::Pending& step);
  void bound_velocity(const ErrorStateFilter::Pending& step);
  void learn_velocity_density(double interval_s);
  void bound_acceleration(const ErrorStateFilter::Pending& step);
  [[nodiscard]] double machine_velocity_m_s() const;
  void watch_bias(const ErrorStateFilter::Pending& step);
  [[nodiscard]] double rate_density() const;
  void measure(int index, double residual, double noise_variance);
  [[nodiscard]] Eigen::Quaterniond shown_attitude() const;

  AttitudeEkfParameters parameters_;
  AttitudeEkfState state_;
};

}  // namespace gimbal

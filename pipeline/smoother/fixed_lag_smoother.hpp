#pragma once

#include <Eigen/Core>
#include <array>
#include <chrono>
#include <cstddef>
#include <deque>
#include <optional>

#include "pipeline/estimator/attitude_ekf.hpp"
#include "pipeline/sample/attitude.hpp"

namespace gimbal {

/// How much of the future an answer may use; none means the whole recording.
using SmootherLag = std::optional<SensorDuration>;

struct FixedLagSmootherParameters {
  AttitudeEkfParameters ekf;
  SmootherLag lag = std::chrono::seconds(1);
  /// Answers are released so much at a time, all from one look back. Longer blocks leave seams.
  SensorDuration block = std::chrono::milliseconds(20);
  /// A later look at the same instant changes its tilt. What was released does not change any more;
  /// what follows comes over to the new tilt within this time, with no step.
  double seam_memory_s = 0.7;
  /// How often the covariance of a fixed lag is worked out anew, at least twice within the lag;
  /// meanwhile it is held, unless the filter's own grows.
  SensorDuration covariance_period = std::chrono::milliseconds(500);
};

/// A filter step as a look back goes over it, again and again while it is held: the updates joined,
/// so that none waits for the other.
struct BackwardStep {
  struct Update {
    int index = 0;
    double residual = 0;  ///< over its variance
    ErrorState gain = ErrorState::Zero();
  };
  std::array<Update, FilterStep::kMaxUpdates> updates;  ///< the first `update_count`
  std::size_t update_count = 0;
  MovingColumns transition = MovingColumns::Zero();
};

/// Orientations with the future taken into account: the attitude EKF forward, then back over its
/// steps by the modified Bryson-Frazier recursion (G. J. Bierman, "Fixed interval smoothing with
/// discrete measurements", Int. J. Control 18(1), 1973), which needs no inverse. With all of the
/// recording the answers are those of a Rauch-Tung-Striebel smoother.
///
/// Answers come at the gyro's stamps. Between the filter's steps the correction is interpolated, so
/// that there are no seams. With a fixed lag every look back knows better what was released: what
/// follows keeps that heading for good, and comes over to the better tilt slowly. Memory: about 2
/// kB a filter step within the lag. The covariance counts what was known too late to be shown.
///
/// Every answer is `exact`: for a sample's very instant, by all samples before it and what the lag
/// allows after it.
class FixedLagSmoother {
 public:
  explicit FixedLagSmoother(const FixedLagSmootherParameters& parameters = {});

  void push(const ImuSample& sample);

  /// No more samples come: what is held is released.
  void finish();

  /// The next answer in order, once enough of the future is known. Samples that the filter skipped
  /// have none.
  [[nodiscard]] std::optional<AttitudeEstimate> pop();

  /// The filter itself: its prediction to now, its bias, what it met.
  [[nodiscard]] const AttitudeEkf& filter() const { return filter_; }

 private:
  struct HeldSample {
    SensorTime time;
    Eigen::Quaterniond q_world_imu;  ///< the filter's, at the sample
  };
  /// A filter step with what the look back says about it.
  struct HeldStep {
    FilterStep step;
    BackwardStep back;
    std::size_t sample_count = 0;  ///< samples since the step before, its own included
    Eigen::Vector3d correction = Eigen::Vector3d::Zero();  ///< rad, world axes
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };

  void take_step();
  void turn_world(const WorldTurn& world);
  void release_ready();
  /// Releases the samples of the steps up to and including `last`, after a look back.
  void release_until(std::size_t last);
  void release_step(const HeldStep& before, const HeldStep& step);
  void release_sample(const Eigen::Vector3d& correction, const Eigen::Matrix3d& covariance);
  /// From the newest step to the oldest; `last` is the latest one whose correction is wanted.
  void look_back(std::size_t last);
  /// The covariance of all steps: the next look's is compared with it.
  void look_back_with_covariance(std::size_t last);
  [[nodiscard]] bool covariance_is_due(const HeldStep& step) const;
  /// Adds what the looks back since the last covariance have changed about the first step, as
  /// `known` has it, and lets what the seams have taken in go.
  void learn_offset_covariance(const Eigen::Matrix3d& known);
  [[nodiscard]] Eigen::Matrix3d shown_covariance(const HeldStep& step) const;

  FixedLagSmootherParameters parameters_;
  AttitudeEkf filter_;
  std::size_t steps_taken_ = 0;
  std::size_t samples_since_step_ = 0;
  std::deque<HeldSample> samples_;  ///< not released yet, the oldest first
  std::deque<HeldStep> steps_;      ///< what is released lies before or at the first one
  bool first_step_is_released_ = false;
  Eigen::Vector3d offset_rad_ =
      Eigen::Vector3d::Zero();  ///< from the latest look back to what is released
  Eigen::Vector3d released_correction_rad_ =
      Eigen::Vector3d::Zero();  ///< at the first step, as released
  /// What `offset_rad_` can be expected to be.
  Eigen::Matrix3d offset_covariance_rad2_ = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d released_covariance_rad2_ = Eigen::Matrix3d::Zero();  ///< while it is held
  std::optional<SensorTime> covariance_time_;  ///< when it was last worked out ...
  double filter_trace_rad2_ = 0;               ///< ... and the filter's own at that step
  std::deque<AttitudeEstimate> ready_;
};

}  // namespace gimbal

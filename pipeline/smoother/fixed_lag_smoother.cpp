#include "pipeline/smoother/fixed_lag_smoother.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

using Index = ErrorIndex;

/// What a look back needs of a step: its updates, used one after the other, as one.
BackwardStep backward(const FilterStep& step) {
  BackwardStep back;
  back.update_count = step.update_count;
  back.transition = step.transition.back_from_attitude_and_velocity();
  for (std::size_t i = step.update_count; i-- > 0;) {
    const ScalarUpdate& update = step.updates[i];
    BackwardStep::Update& joint = back.updates[i];
    joint = {update.index, update.residual / update.variance, update.gain};
    for (std::size_t later = i + 1; later < step.update_count; ++later) {
      const double seen = update.gain(back.updates[later].index);
      joint.residual -= seen * back.updates[later].residual;
      joint.gain -= seen * back.updates[later].gain;
    }
  }
  return back;
}

/// What later measurements say about a step: the adjoint of Bierman's recursion, so that the
/// smoothed error is -P λ. Here from after a step's updates to the step before.
void go_back_over(const BackwardStep& step, ErrorState& adjoint) {
  std::array<double, FilterStep::kMaxUpdates> less{};
  for (std::size_t i = 0; i < step.update_count; ++i) {
    less[i] = step.updates[i].gain.dot(adjoint) + step.updates[i].residual;
  }
  for (std::size_t i = 0; i < step.update_count; ++i) adjoint(step.updates[i].index) -= less[i];
  Eigen::Matrix<double, 6, 1> moving;
  moving << adjoint.segment<3>(Index::attitude), adjoint.segment<3>(Index::velocity);
  adjoint += step.transition.lazyProduct(moving);
}

/// The same for the covariance of the adjoint, Λ: the smoothed covariance is P - P Λ P.
void undo_updates(const FilterStep& step, ErrorCovariance& information) {
  for (std::size_t i = step.update_count; i-- > 0;) {
    const ScalarUpdate& update = step.updates[i];
    const int k = update.index;
    const ErrorState by_gain = information * update.gain;
    const double diagonal =
        information(k, k) - 2 * by_gain(k) + update.gain.dot(by_gain) + 1 / update.variance;
    information.col(k) -= by_gain;
    information.row(k) -= by_gain.transpose();
    information(k, k) = diagonal;
  }
}

/// X F, with F of the step.
ErrorCovariance times_transition(const ErrorCovariance& X, const BackwardStep& step) {
  MovingColumns moving;
  moving << X.middleCols<3>(Index::attitude), X.middleCols<3>(Index::velocity);
  ErrorCovariance product = X;
  for (int i = 0; i < Index::size; ++i) {
    product.col(i).noalias() += moving.lazyProduct(step.transition.row(i).transpose());
  }
  return product;
}

/// Fᵀ Λ F.
ErrorCovariance back_through(const BackwardStep& step, const ErrorCovariance& information) {
  const ErrorCovariance half = times_transition(information, step).transpose();
  return times_transition(half, step);
}

Eigen::Vector3d smoothed_correction(const FilterStep& step, const ErrorState& adjoint) {
  return -(step.attitude_rows * adjoint);
}

Eigen::Matrix3d smoothed_covariance(const FilterStep& step, const ErrorCovariance& information) {
  return step.attitude_rows.middleCols<3>(Index::attitude) -
         step.attitude_rows * information * step.attitude_rows.transpose();
}

double filter_trace(const FilterStep& step) {
  return step.attitude_rows.middleCols<3>(Index::attitude).trace();
}

/// Tilt first, then heading, which may have gone round more than once. Tilt corrections are small.
Eigen::Quaterniond rotation_by(const Eigen::Vector3d& correction) {
  return rotation_from_vector({0, 0, correction.z()}) *
         rotation_from_vector({correction.x(), correction.y(), 0});
}

/// The correction at the end of a step before its updates, whose own correction it includes.
Eigen::Vector3d correction_before_updates(const Eigen::Vector3d& correction,
                                          const FilterStep& step) {
  const Eigen::Vector3d tilt(correction.x(), correction.y(), 0);
  const Eigen::Vector3d both = vector_from_rotation(rotation_from_vector(tilt) *
                                                    rotation_from_vector(step.attitude_correction));
  return {both.x(), both.y(), correction.z() + both.z()};
}

}  // namespace

FixedLagSmoother::FixedLagSmoother(const FixedLagSmootherParameters& parameters)
    : parameters_(parameters), filter_(parameters.ekf) {}

void FixedLagSmoother::push(const ImuSample& sample) {
  const std::size_t skipped = filter_.counts().skipped_gyro;
  filter_.update(sample);
  if (filter_.counts().skipped_gyro != skipped) return;
  samples_.push_back({sample.time, filter_.state().filter.mean().q_world_imu});
  ++samples_since_step_;
  if (filter_.state().step_count == steps_taken_) return;
  take_step();
  release_ready();
}

void FixedLagSmoother::take_step() {
  const FilterStep& step = filter_.state().step;
  steps_.push_back({step, backward(step), samples_since_step_});
  if (step.world_turn) turn_world(*step.world_turn);
  steps_taken_ = filter_.state().step_count;
  samples_since_step_ = 0;
}

void FixedLagSmoother::turn_world(const WorldTurn& world) {
  // What came before the tilt was known is turned along, and its tilt is as uncertain: back to
  // where it started anew, if it did. The newest sample and the newest covariance are in the new
  // world already.
  std::size_t first = steps_.size();
  std::size_t samples = 0;
  for (bool starts_anew = false; first > 0 && !starts_anew;) {
    const HeldStep& held = steps_[--first];
    starts_anew = !held.step.transition.is_continuous;
    samples += starts_anew ? 1 : held.sample_count;  // those before the hole stay
  }
  for (std::size_t i = samples_.size() - std::min(samples, samples_.size());
       i + 1 < samples_.size(); ++i) {
    samples_[i].q_world_imu = world.turn * samples_[i].q_world_imu;
  }
  const Eigen::Matrix3d R = world.turn.toRotationMatrix();
  for (std::size_t i = first; i < steps_.size(); ++i) {
    HeldStep& held = steps_[i];
    if (i + 1 < steps_.size()) held.step.attitude_rows += world.rows;
    ErrorTransition& F = held.step.transition;
    F.attitude_by_gyro_bias = (R * F.attitude_by_gyro_bias).eval();
    F.attitude_by_gyro_scale = (R * F.attitude_by_gyro_scale).eval();
    held.step.attitude_correction = (R * held.step.attitude_correction).eval();
    for (std::size_t k = 0; k < held.step.update_count; ++k) {
      ErrorState& gain = held.step.updates[k].gain;
      gain.segment<3>(Index::attitude) =
          (R * gain.segment<3>(Index::attitude) +
           world.attitude_by_gyro_bias * gain.segment<3>(Index::gyro_bias))
              .eval();
    }
    held.back = backward(held.step);
  }
}

void FixedLagSmoother::release_ready() {
  if (!parameters_.lag || steps_.size() < 2) return;
  const SensorTime newest_ready = steps_.back().step.time - *parameters_.lag;
  std::size_t last = 0;
  while (last + 1 < steps_.size() && steps_[last + 1].step.time <= newest_ready) ++last;
  if (last == 0) return;
  const bool block_is_full =
      steps_[last].step.time - steps_.front().step.time + parameters_.ekf.step / 2 >
      parameters_.block;
  if (!block_is_full) return;
  if (covariance_is_due(steps_[last])) {
    const Eigen::Matrix3d known = steps_.front().covariance;
    look_back_with_covariance(last);
    if (covariance_time_) learn_offset_covariance(known);
    covariance_time_ = steps_[last].step.time;
    filter_trace_rad2_ = filter_trace(steps_[last].step);
    released_covariance_rad2_ = shown_covariance(steps_[last]);
  } else {
    look_back(last);
  }
  release_until(last);
}

bool FixedLagSmoother::covariance_is_due(const HeldStep& step) const {
  constexpr double kMuchMore = 1.2;
  const SensorDuration period = std::min(parameters_.covariance_period, *parameters_.lag / 2);
  return !covariance_time_ || step.step.time - *covariance_time_ >= period ||
         filter_trace(step.step) > kMuchMore * filter_trace_rad2_;
}

void FixedLagSmoother::learn_offset_covariance(const Eigen::Matrix3d& known) {
  const HeldStep& first = steps_.front();
  const double interval_s = to_seconds(first.step.time - *covariance_time_);
  const double kept = std::exp(-interval_s / parameters_.seam_memory_s);
  const Eigen::DiagonalMatrix<double, 3> fade(kept, kept, 1);
  offset_covariance_rad2_ = fade * (offset_covariance_rad2_ + known - first.covariance) * fade;
}

Eigen::Matrix3d FixedLagSmoother::shown_covariance(const HeldStep& step) const {
  return step.covariance + offset_covariance_rad2_;
}

void FixedLagSmoother::finish() {
  if (steps_.empty()) return;
  const Eigen::Matrix3d known = steps_.front().covariance;
  const std::size_t last = steps_.size() - 1;
  look_back_with_covariance(last);
  if (covariance_time_) learn_offset_covariance(known);
  covariance_time_.reset();
  release_until(last);
  // After the last step the filter has measured nothing.
  while (!samples_.empty()) {
    release_sample(steps_.front().correction + offset_rad_, shown_covariance(steps_.front()));
  }
}

std::optional<AttitudeEstimate> FixedLagSmoother::pop() {
  if (ready_.empty()) return std::nullopt;
  const AttitudeEstimate estimate = ready_.front();
  ready_.pop_front();
  return estimate;
}

void FixedLagSmoother::look_back(std::size_t last) {
  ErrorState adjoint = ErrorState::Zero();
  for (std::size_t i = steps_.size(); i-- > 0;) {
    HeldStep& held = steps_[i];
    if (i <= last) held.correction = smoothed_correction(held.step, adjoint);
    go_back_over(held.back, adjoint);
  }
}

void FixedLagSmoother::look_back_with_covariance(std::size_t last) {
  look_back(last);
  ErrorCovariance information = ErrorCovariance::Zero();
  for (std::size_t i = steps_.size(); i-- > 0;) {
    HeldStep& held = steps_[i];
    held.covariance = smoothed_covariance(held.step, information);
    undo_updates(held.step, information);
    information = back_through(held.back, information);
  }
}

void FixedLagSmoother::release_until(std::size_t last) {
  if (first_step_is_released_) {
    offset_rad_ = released_correction_rad_ - steps_.front().correction;
  } else {
    release_sample(steps_.front().correction, shown_covariance(steps_.front()));
    first_step_is_released_ = true;
  }
  for (; last > 0; --last) {
    release_step(steps_[0], steps_[1]);
    steps_.pop_front();
  }
  released_correction_rad_ = steps_.front().correction + offset_rad_;
}

void FixedLagSmoother::release_step(const HeldStep& before, const HeldStep& step) {
  const double length_s = to_seconds(step.step.time - before.step.time);
  const Eigen::Vector3d offset_at_start = offset_rad_;
  offset_rad_.head<2>() *= std::exp(-length_s / parameters_.seam_memory_s);
  const Eigen::Vector3d at_start = before.correction + offset_at_start;
  const Eigen::Vector3d at_end =
      offset_rad_ + (step.step.transition.is_continuous
                         ? correction_before_updates(step.correction, step.step)
                         : before.correction);
  const Eigen::Matrix3d covariance =
      covariance_time_ ? released_covariance_rad2_ : shown_covariance(step);
  for (std::size_t i = 1; i < step.sample_count; ++i) {
    const double fraction = to_seconds(samples_.front().time - before.step.time) / length_s;
    release_sample(at_start + fraction * (at_end - at_start), covariance);
  }
  release_sample(step.correction + offset_rad_, covariance);
}

void FixedLagSmoother::release_sample(const Eigen::Vector3d& correction,
                                      const Eigen::Matrix3d& covariance) {
  const HeldSample& sample = samples_.front();
  const Eigen::Quaterniond q =
      rotation_by(correction) * filter_.turn_upright() * sample.q_world_imu;
  ready_.push_back({{sample.time, q.normalized()}, covariance, AttitudeOrigin::exact});
  samples_.pop_front();
}

}  // namespace gimbal

#include "pipeline/estimator/spike_gate.hpp"

#include <cmath>

namespace gimbal {

SpikeGate::SpikeGate(const SpikeGateParameters& parameters)
    : parameters_(parameters),
      gyro_{parameters.smallest_gyro_spike_rad_s},
      accel_{parameters.smallest_accel_spike_m_s2} {}

SpikeGate::Passed SpikeGate::push(const ImuSample& sample) {
  Passed passed;
  if (held_) judge_held(sample, passed);
  if (steps_far(sample)) {
    held_ = sample;
  } else {
    pass(sample, passed);
  }
  return passed;
}

SpikeGate::Passed SpikeGate::finish() {
  Passed passed;
  if (held_) pass(*held_, passed);
  held_.reset();
  return passed;
}

bool SpikeGate::steps_far(const ImuSample& sample) const {
  if (!last_ || sample.time - last_->time > parameters_.longest_interval) return false;
  return is_far(gyro_, sample.gyro_rad_s - last_->gyro_rad_s) ||
         (sample.accel_m_s2 && last_->accel_m_s2 &&
          is_far(accel_, *sample.accel_m_s2 - *last_->accel_m_s2));
}

/// False for what is no number, which is the filter's to refuse.
bool SpikeGate::is_far(const Steps& steps, const Eigen::Vector3d& step) const {
  return step.norm() > steps.smallest &&
         step.norm() > parameters_.usual_steps * std::sqrt(steps.mean_square);
}

/// Whether `value` alone is away from where its neighbours are. What shakes it would move them too.
bool SpikeGate::sticks_out(const Steps& steps, const Eigen::Vector3d& before,
                           const Eigen::Vector3d& value, const Eigen::Vector3d& after) const {
  const double usual = parameters_.usual_steps / 2 * std::sqrt(steps.mean_square);
  return is_far(steps, value - before) && (after - before).norm() <= usual;
}

void SpikeGate::judge_held(const ImuSample& next, Passed& passed) {
  ImuSample held = *held_;
  held_.reset();
  const bool next_tells = next.time - held.time <= parameters_.longest_interval;
  if (next_tells && sticks_out(gyro_, last_->gyro_rad_s, held.gyro_rad_s, next.gyro_rad_s)) {
    ++spikes_;
    return;
  }
  if (next_tells && held.accel_m_s2 && last_->accel_m_s2 && next.accel_m_s2 &&
      sticks_out(accel_, *last_->accel_m_s2, *held.accel_m_s2, *next.accel_m_s2)) {
    ++spikes_;
    held.accel_m_s2.reset();
  }
  pass(held, passed);
}

void SpikeGate::pass(const ImuSample& sample, Passed& passed) {
  passed.samples[passed.count++] = sample;
  if (!sample.gyro_rad_s.allFinite()) return;
  if (last_) {
    const double interval_s = to_seconds(sample.time - last_->time);
    learn(gyro_, sample.gyro_rad_s - last_->gyro_rad_s, interval_s);
    if (sample.accel_m_s2 && last_->accel_m_s2) {
      learn(accel_, *sample.accel_m_s2 - *last_->accel_m_s2, interval_s);
    }
  }
  last_ = sample;
}

void SpikeGate::learn(Steps& steps, const Eigen::Vector3d& step, double interval_s) const {
  if (!(interval_s > 0) || !step.allFinite()) return;
  steps.mean_square -=
      std::expm1(-interval_s / parameters_.memory_s) * (step.squaredNorm() - steps.mean_square);
}

}  // namespace gimbal

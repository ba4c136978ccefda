#include "pipeline/timing/imu_aligner.hpp"

#include <algorithm>
#include <iterator>

namespace gimbal {

ImuAligner::ImuAligner(Accelerometer accelerometer, const ImuAlignerParameters& parameters)
    : accelerometer_(accelerometer), parameters_(parameters) {}

bool ImuAligner::push(const GyroSample& sample) {
  if (!sample.gyro_rad_s.allFinite() || (last_gyro_ && sample.time <= *last_gyro_)) {
    ++refused_;
    return false;
  }
  last_gyro_ = sample.time;
  waiting_.push_back(sample);
  align();
  return true;
}

bool ImuAligner::push(const AccelSample& sample) {
  if (!sample.accel_m_s2.allFinite() || (last_accel_ && sample.time <= *last_accel_)) {
    ++refused_;
    return false;
  }
  last_accel_ = sample.time;
  accel_.push_back(sample);
  align();
  forget_accel_before(sample.time - parameters_.patience);
  return true;
}

void ImuAligner::finish() {
  finished_ = true;
  align();
}

std::optional<ImuSample> ImuAligner::pop() {
  if (ready_.empty()) return std::nullopt;
  ImuSample sample = ready_.front();
  ready_.pop_front();
  return sample;
}

void ImuAligner::align() {
  while (!waiting_.empty() && !must_wait(waiting_.front())) {
    const GyroSample& gyro = waiting_.front();
    ready_.push_back({gyro.time, gyro.gyro_rad_s, accel_at(gyro.time)});
    forget_accel_before(gyro.time);
    waiting_.pop_front();
  }
}

bool ImuAligner::must_wait(const GyroSample& sample) const {
  if (accelerometer_ == Accelerometer::absent || finished_) return false;
  const bool accel_has_passed = last_accel_ && *last_accel_ >= sample.time;
  return !accel_has_passed && *last_gyro_ - sample.time <= parameters_.patience;
}

std::optional<Eigen::Vector3d> ImuAligner::accel_at(SensorTime time) const {
  const auto after = std::ranges::lower_bound(accel_, time, {}, &AccelSample::time);
  if (after == accel_.end()) return std::nullopt;
  const auto first = after == accel_.begin();
  const SensorDuration gap = after->time - (first ? time : std::prev(after)->time);
  if (after->time == time) return after->accel_m_s2;
  if (gap > parameters_.max_accel_gap) return std::nullopt;
  if (first) return after->accel_m_s2;
  const auto before = std::prev(after);
  const double fraction = to_seconds(time - before->time) / to_seconds(gap);
  return before->accel_m_s2 + fraction * (after->accel_m_s2 - before->accel_m_s2);
}

void ImuAligner::forget_accel_before(SensorTime time) {
  // One sample at or before that instant stays, to interpolate from.
  while (accel_.size() > 1 && accel_[1].time <= time) accel_.pop_front();
}

}  // namespace gimbal

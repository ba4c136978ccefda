#include "pipeline/timing/imu_aligner.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gimbal {

ImuAligner::ImuAligner(Accelerometer accelerometer, const ImuAlignerParameters& parameters)
    : accelerometer_(accelerometer), parameters_(parameters) {}

bool ImuAligner::push(const GyroSample& sample) {
  if (!sample.gyro_rad_s.allFinite() || (last_gyro_ && sample.time <= *last_gyro_)) {
    ++refused_;
    return false;
  }
  if (waits_for_the_next(sample, last_gyro_, gyro_far_ahead_)) return true;
  if (gyro_far_ahead_) take(*std::exchange(gyro_far_ahead_, std::nullopt));
  take(sample);
  return true;
}

void ImuAligner::take(const GyroSample& sample) {
  last_gyro_ = sample.time;
  waiting_.push_back(sample);
  align();
}

bool ImuAligner::push(const AccelSample& sample) {
  if (!sample.accel_m_s2.allFinite() || (last_accel_ && sample.time <= *last_accel_)) {
    ++refused_;
    return false;
  }
  if (waits_for_the_next(sample, last_accel_, accel_far_ahead_)) return true;
  if (accel_far_ahead_) take(*std::exchange(accel_far_ahead_, std::nullopt));
  take(sample);
  return true;
}

void ImuAligner::take(const AccelSample& sample) {
  last_accel_ = sample.time;
  accel_.push_back(sample);
  align();
  forget_accel_before(sample.time - parameters_.patience);
}

template <typename Sample>
bool ImuAligner::waits_for_the_next(const Sample& sample, std::optional<SensorTime> last,
                                    std::optional<Sample>& far_ahead) {
  const SensorDuration near = parameters_.patience;
  if (!last) return false;
  if (far_ahead && sample.time > far_ahead->time && sample.time - far_ahead->time <= near) {
    return false;
  }
  if (far_ahead) ++refused_;
  far_ahead.reset();
  if (sample.time - *last > near) far_ahead = sample;
  return far_ahead.has_value();
}

void ImuAligner::finish() {
  refused_ += (gyro_far_ahead_ ? 1U : 0U) + (accel_far_ahead_ ? 1U : 0U);
  gyro_far_ahead_.reset();
  accel_far_ahead_.reset();
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

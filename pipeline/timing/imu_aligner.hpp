#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

/// Whether a gyroscope has an accelerometer beside it to wait for.
enum class Accelerometer : std::uint8_t { present, absent };

struct ImuAlignerParameters {
  /// Accelerometer samples further apart are not interpolated between.
  SensorDuration max_accel_gap = std::chrono::milliseconds(100);
  /// How far one stream may run ahead of the other before it no longer waits. At least
  /// max_accel_gap.
  SensorDuration patience = std::chrono::seconds(1);
};

/// Interpolates the accelerometer to the gyroscope's stamps (thesis 4.3), as samples come in. What
/// comes out does not depend on how the two streams are interleaved, as long as neither is ahead of
/// the other by more than the patience; memory is bounded by it.
///
/// A gyro sample waits for an accelerometer sample at or after its instant. It goes without one
/// inside a gap, after the last one, or when its patience ends. Before the first one, that one's
/// value serves as far back as max_accel_gap, so that the tilt is known from the start.
class ImuAligner {
 public:
  explicit ImuAligner(Accelerometer accelerometer, const ImuAlignerParameters& parameters = {});

  /// False for a sample that is refused: its stamp is not later than the last one's of its kind, or
  /// its values are not finite. A stamp that is further ahead than the patience waits for the next
  /// one to bear it out, and is refused then if that does not: alone, it would make all that
  /// follow too late.
  bool push(const GyroSample& sample);
  bool push(const AccelSample& sample);

  /// No more samples come: nothing waits any longer.
  void finish();

  /// The next sample in order of time, once its accelerometer value is known.
  [[nodiscard]] std::optional<ImuSample> pop();

  [[nodiscard]] std::size_t refused() const { return refused_; }

 private:
  void take(const GyroSample& sample);
  void take(const AccelSample& sample);
  template <typename Sample>
  [[nodiscard]] bool waits_for_the_next(const Sample& sample, std::optional<SensorTime> last,
                                        std::optional<Sample>& far_ahead);
  void align();
  [[nodiscard]] bool must_wait(const GyroSample& sample) const;
  [[nodiscard]] std::optional<Eigen::Vector3d> accel_at(SensorTime time) const;
  void forget_accel_before(SensorTime time);

  Accelerometer accelerometer_;
  ImuAlignerParameters parameters_;
  std::deque<GyroSample> waiting_;
  std::deque<AccelSample> accel_;
  std::deque<ImuSample> ready_;
  std::optional<SensorTime> last_gyro_;
  std::optional<SensorTime> last_accel_;
  std::optional<GyroSample> gyro_far_ahead_;  ///< that nothing bears out yet
  std::optional<AccelSample> accel_far_ahead_;
  std::size_t refused_ = 0;
  bool finished_ = false;
};

}  // namespace gimbal

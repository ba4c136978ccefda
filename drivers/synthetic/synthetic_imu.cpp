#include "drivers/synthetic/synthetic_imu.hpp"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/world.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {
namespace {

constexpr double kHighestRate_hz = 1e5;

// Each sensor draws its noise from a stream of its own.
constexpr std::uint64_t kGyroStream = 0;
constexpr std::uint64_t kAccelStream = 1;

/// Errs like a sensor, sample after sample.
class ErringSensor {
 public:
  ErringSensor(const TriaxialErrors& errors, double rate_hz, std::uint64_t seed)
      : errors_(errors), rate_hz_(rate_hz), bias_(errors.bias), random_(seed) {}

  Eigen::Vector3d measure(const Eigen::Vector3d& truth) {
    const double noise = errors_.noise_density * std::sqrt(0.5 * rate_hz_);
    const Eigen::Vector3d value =
        errors_.scale.cwiseProduct(truth) + bias_ + noise * normal_vector();
    return value.cwiseMax(-errors_.full_scale).cwiseMin(errors_.full_scale);
  }

  void let_bias_walk() { bias_ += errors_.bias_walk / std::sqrt(rate_hz_) * normal_vector(); }

  [[nodiscard]] const Eigen::Vector3d& bias() const { return bias_; }

 private:
  Eigen::Vector3d normal_vector() {
    const double x = random_.normal();
    const double y = random_.normal();
    return {x, y, random_.normal()};
  }

  TriaxialErrors errors_;
  double rate_hz_;
  Eigen::Vector3d bias_;
  Random random_;
};

std::vector<SensorTime> sample_times(const SampleClock& clock, const TimeSpan& span) {
  std::vector<SensorTime> times;
  if (clock.rate_hz == 0.0) return times;
  for (std::int64_t i = 0;; ++i) {
    const SensorTime time =
        span.from + clock.phase + duration_from_seconds(static_cast<double>(i) / clock.rate_hz);
    if (time >= span.to) return times;
    times.push_back(time);
  }
}

bool is_lost(SensorTime time, const std::vector<TimeSpan>& dropouts) {
  return std::ranges::any_of(
      dropouts, [&](const TimeSpan& gap) { return gap.from <= time && time < gap.to; });
}

Result<void> check_rate(double rate_hz, const char* sensor) {
  if (rate_hz >= 0.0 && rate_hz <= kHighestRate_hz) return {};
  return bad_input(fmt::format("synthetic {}: {} samples/s: must lie between 0 and {}", sensor,
                               rate_hz, kHighestRate_hz));
}

Result<void> check(const SyntheticImuSettings& settings) {
  const Eigen::Matrix3d& R = settings.R_camera_imu;
  if (!R.isUnitary(1e-4) || R.determinant() < 0.0) {
    return bad_input(
        "synthetic IMU: R_camera_imu is not a rotation: its rows must be of length 1, "
        "at right angles and right-handed");
  }
  if (settings.span.to < settings.span.from) {
    return bad_input("synthetic IMU: the span ends before it begins");
  }
  if (Result<void> gyro = check_rate(settings.gyro_clock.rate_hz, "gyroscope"); !gyro) return gyro;
  return check_rate(settings.accel_clock.rate_hz, "accelerometer");
}

}  // namespace

Eigen::Vector3d true_gyro(const MotionState& state, const Eigen::Matrix3d& R_camera_imu) {
  return R_camera_imu.transpose() * state.rate_rad_s;
}

Eigen::Vector3d true_specific_force(const MotionState& state, const Eigen::Matrix3d& R_camera_imu) {
  const Eigen::Vector3d gravity(0, 0, -kStandardGravity_m_s2);
  const Eigen::Vector3d force_world = state.acceleration_m_s2 - gravity;
  return R_camera_imu.transpose() * (state.q_world_camera.conjugate() * force_world);
}

Result<std::unique_ptr<SyntheticImu>> SyntheticImu::create(const SyntheticImuSettings& settings,
                                                           const Motion& motion) {
  if (Result<void> checked = check(settings); !checked) return tl::unexpected(checked.error());
  std::unique_ptr<SyntheticImu> imu(new SyntheticImu);

  ErringSensor gyroscope(settings.gyro, settings.gyro_clock.rate_hz,
                         stream_seed(settings.seed, kGyroStream));
  for (const SensorTime time : sample_times(settings.gyro_clock, settings.span)) {
    const Eigen::Vector3d rate =
        gyroscope.measure(true_gyro(motion.at(time), settings.R_camera_imu));
    if (!is_lost(time, settings.dropouts)) {
      imu->gyro_.push_back({time + settings.clock_offset, rate});
      imu->gyro_bias_.push_back(gyroscope.bias());
    }
    gyroscope.let_bias_walk();
  }

  ErringSensor accelerometer(settings.accel, settings.accel_clock.rate_hz,
                             stream_seed(settings.seed, kAccelStream));
  for (const SensorTime time : sample_times(settings.accel_clock, settings.span)) {
    const Eigen::Vector3d force =
        accelerometer.measure(true_specific_force(motion.at(time), settings.R_camera_imu));
    if (!is_lost(time, settings.dropouts)) {
      imu->accel_.push_back({time + settings.clock_offset, force});
    }
    accelerometer.let_bias_walk();
  }
  return imu;
}

Result<void> SyntheticImu::start() {
  next_gyro_ = 0;
  next_accel_ = 0;
  running_ = true;
  return {};
}

void SyntheticImu::stop() {
  running_ = false;
}

Result<std::optional<ImuReading>> SyntheticImu::read() {
  if (!running_) return std::nullopt;
  const bool has_gyro = next_gyro_ < gyro_.size();
  const bool has_accel = next_accel_ < accel_.size();
  if (!has_gyro && !has_accel) return std::nullopt;
  if (has_gyro && (!has_accel || gyro_[next_gyro_].time <= accel_[next_accel_].time)) {
    return ImuReading(gyro_[next_gyro_++]);
  }
  return ImuReading(accel_[next_accel_++]);
}

}  // namespace gimbal

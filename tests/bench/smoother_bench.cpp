#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <chrono>

#include "pipeline/smoother/attitude_history.hpp"
#include "pipeline/smoother/fixed_lag_smoother.hpp"

namespace {

using namespace std::chrono_literals;
using gimbal::Attitude;
using gimbal::AttitudeHistory;
using gimbal::SensorTime;

/// Ten seconds at 200 Hz of a camera that turns evenly.
AttitudeHistory even_turn() {
  AttitudeHistory history(20ms);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::AngleAxisd turn(1e-3 * i, Eigen::Vector3d::UnitY());
    history.append({{SensorTime(i * 5ms), Eigen::Quaterniond(turn)}});
  }
  return history;
}

/// The orientation of one row: 21 of these make the mesh of a frame.
void attitude_of_a_row(benchmark::State& state) {
  const AttitudeHistory history = even_turn();
  SensorTime time(0ms);
  for (auto _ : state) {
    benchmark::DoNotOptimize(history.at(time));
    time += 1500us;
    if (time > SensorTime(9900ms)) time = SensorTime(0ms);
  }
}
BENCHMARK(attitude_of_a_row);

/// What a video frame (30 a second) costs the smoother with 1 s of lag: its share of the IMU's
/// samples, the filter included.
class SmootherFrame {
 public:
  explicit SmootherFrame(std::chrono::nanoseconds interval,
                         gimbal::SensorDuration covariance_period =
                             gimbal::FixedLagSmootherParameters{}.covariance_period)
      : smoother_(with_covariance_every(covariance_period)), interval_(interval) {
    for (int i = 0; i < 60; ++i) pass();  // the lag is full
  }

  void pass() {
    end_ += 33333us;
    for (; sample_.time < end_; sample_.time += interval_) {
      sample_.gyro_rad_s.x() = -sample_.gyro_rad_s.x();
      smoother_.push(sample_);
    }
    while (const auto answer = smoother_.pop()) benchmark::DoNotOptimize(*answer);
  }

 private:
  static gimbal::FixedLagSmootherParameters with_covariance_every(gimbal::SensorDuration period) {
    gimbal::FixedLagSmootherParameters parameters;
    parameters.covariance_period = period;
    return parameters;
  }

  gimbal::FixedLagSmoother smoother_;
  gimbal::ImuSample sample_{SensorTime(0ms), {0.1, -0.2, 0.05}, Eigen::Vector3d(0.3, 9.7, -0.4)};
  std::chrono::nanoseconds interval_;
  SensorTime end_{0ms};
};

void smoother_frame(benchmark::State& state) {
  SmootherFrame frame(1000000000ns / state.range(0));
  for (auto _ : state) frame.pass();
}
BENCHMARK(smoother_frame)->ArgName("Hz")->Arg(50)->Arg(100)->Arg(210);

/// The slowest of frames: every look back works out the covariance too, which else is done twice a
/// second.
void smoother_slowest_frame(benchmark::State& state) {
  SmootherFrame frame(4762us, 0ns);
  for (auto _ : state) frame.pass();
}
BENCHMARK(smoother_slowest_frame);

}  // namespace

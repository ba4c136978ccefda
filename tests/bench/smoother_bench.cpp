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

/// What a video frame (30 a second) costs the smoother with 1 s of lag: its share of a 210 Hz IMU's
/// samples, the filter included.
void smoother_frame(benchmark::State& state) {
  gimbal::FixedLagSmoother smoother;
  gimbal::ImuSample sample{SensorTime(0ms), {0.1, -0.2, 0.05}, Eigen::Vector3d(0.3, 9.7, -0.4)};
  const auto frame = [&] {
    for (int i = 0; i < 7; ++i) {
      sample.gyro_rad_s.x() = -sample.gyro_rad_s.x();
      smoother.push(sample);
      sample.time += 4762us;
    }
    while (const auto answer = smoother.pop()) benchmark::DoNotOptimize(*answer);
  };
  for (int i = 0; i < 60; ++i) frame();  // the lag is full
  for (auto _ : state) frame();
}
BENCHMARK(smoother_frame);

}  // namespace

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <chrono>

#include "pipeline/smoother/attitude_history.hpp"

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
    history.append({SensorTime(i * 5ms), Eigen::Quaterniond(turn)});
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

}  // namespace

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include "pipeline/path/camera_path.hpp"

namespace {

using namespace std::chrono_literals;
using gimbal::CameraPath;
using gimbal::PathFrame;
using gimbal::SensorTime;

/// A camera that sways slowly, at 30 frames a second.
PathFrame swaying_frame(std::int64_t index) {
  const double angle_rad = 0.1 * std::sin(0.05 * static_cast<double>(index));
  return {{{index, SensorTime(index * 33333us), std::nullopt},
           Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()))},
          {},
          [](const Eigen::Quaterniond&) { return 0.0; }};
}

/// One frame through the path, once its window is full.
void path_frame(benchmark::State& state, std::unique_ptr<CameraPath> path) {
  std::int64_t index = 0;
  while (index < 200) path->push(swaying_frame(index++));
  while (path->pop()) {
  }
  for (auto _ : state) {
    path->push(swaying_frame(index++));
    benchmark::DoNotOptimize(path->pop());
  }
}

void hann_path_frame(benchmark::State& state) {
  path_frame(state, gimbal::make_hann_path(99, {}, PathLatency{}));
}
BENCHMARK(hann_path_frame);

void adaptive_hann_path_frame(benchmark::State& state) {
  path_frame(state, gimbal::make_adaptive_hann_path({}, {}, PathLatency{}));
}
BENCHMARK(adaptive_hann_path_frame);

}  // namespace

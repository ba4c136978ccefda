#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <chrono>

#include "pipeline/estimator/thesis_ekf.hpp"

namespace {

using namespace std::chrono_literals;
using gimbal::ImuSample;
using gimbal::SensorTime;
using gimbal::ThesisEkf;

/// One sample of gyroscope and accelerometer: a 200 Hz IMU asks for 200 of these a second.
void thesis_ekf_sample(benchmark::State& state) {
  ThesisEkf ekf;
  ImuSample sample{SensorTime(0ms), {0.1, -0.2, 0.05}, Eigen::Vector3d(0.3, 9.7, -0.4)};
  for (auto _ : state) {
    benchmark::DoNotOptimize(ekf.update(sample));
    sample.time += 5ms;
  }
}
BENCHMARK(thesis_ekf_sample);

}  // namespace

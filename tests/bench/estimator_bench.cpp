#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <chrono>

#include "pipeline/estimator/attitude_ekf.hpp"
#include "pipeline/estimator/thesis_ekf.hpp"

namespace {

using namespace std::chrono_literals;
using gimbal::AttitudeEkf;
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

/// The same for the error-state filter, one step of its covariance every 20 ms included.
void attitude_ekf_sample(benchmark::State& state) {
  AttitudeEkf ekf;
  ImuSample sample{SensorTime(0ms), {0.1, -0.2, 0.05}, Eigen::Vector3d(0.3, 9.7, -0.4)};
  for (auto _ : state) {
    sample.gyro_rad_s.x() = -sample.gyro_rad_s.x();  // an axis that repeats itself would be stuck
    benchmark::DoNotOptimize(ekf.update(sample));
    sample.time += 5ms;
  }
}
BENCHMARK(attitude_ekf_sample);

}  // namespace

#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "pipeline/lens/lens.hpp"

namespace {

using gimbal::Lens;
using gimbal::LensModel;
using gimbal::LensParameters;

/// A 720p camera of about 60° with the distortion of a common phone.
Lens camera_lens(LensModel model, std::vector<double> distortion) {
  LensParameters parameters;
  parameters.model = model;
  parameters.K << 1223.0, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1;
  parameters.distortion = std::move(distortion);
  return Lens::create(std::move(parameters)).value();
}

/// From a pixel near the corner to its ray and back, as each vertex of a mesh needs it.
void lens_round_trip(benchmark::State& state, LensModel model, std::vector<double> distortion) {
  const Lens lens = camera_lens(model, std::move(distortion));
  const Eigen::Vector2d pixel(1100, 600);
  for (auto _ : state) benchmark::DoNotOptimize(lens.project(lens.unproject(pixel).value()));
}
BENCHMARK_CAPTURE(lens_round_trip, pinhole, LensModel::pinhole, {});
BENCHMARK_CAPTURE(lens_round_trip, brown, LensModel::brown, {0.1, -0.2, 1e-4, 2e-4, 0.05});
BENCHMARK_CAPTURE(lens_round_trip, fisheye, LensModel::fisheye, {0.02, -0.01, 0.003, -0.001});

}  // namespace

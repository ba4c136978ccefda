// What one frame costs: the mesh, the count of border pixels, and each warper.

#include <benchmark/benchmark.h>

#include <cmath>

#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

PinholeIntrinsics intrinsics_of(ImageSize size) {
  return {0.955 * size.width, 0.955 * size.width, size.width / 2.0, size.height / 2.0};
}

/// A view zoomed by 1.15, rolled by 3 degrees and panned a little while the rows are read.
WarpMesh make_mesh(ImageSize size) {
  const PinholeIntrinsics k = intrinsics_of(size);
  LensParameters parameters;
  parameters.K << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  const Lens lens = Lens::create(parameters).value();
  const auto q_world_camera = [&](double line) {
    return Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitZ()) *
           Eigen::Quaterniond(
               Eigen::AngleAxisd(0.03 * line / size.height, Eigen::Vector3d::UnitY()));
  };
  VirtualCamera camera;
  camera.intrinsics = {1.15 * k.fx, 1.15 * k.fy, k.cx, k.cy};
  return build_warp_mesh(lens, size, ReadoutDirection::top_down, q_world_camera, camera, size,
                         Border::crop, {});
}

VideoFrame make_frame(ImageSize size) {
  Nv12Buffer picture(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      picture.luma().data[y * picture.luma().stride_bytes + x] =
          static_cast<std::uint8_t>((x * 7) ^ (y * 13));
    }
  }
  const ImageSize chroma = chroma_size(size);
  for (int y = 0; y < chroma.height; ++y) {
    for (int x = 0; x < 2 * chroma.width; ++x) {
      picture.chroma().data[y * picture.chroma().stride_bytes + x] =
          static_cast<std::uint8_t>(x + y);
    }
  }
  return std::move(picture).publish({}, {});
}

ImageSize size_of(const benchmark::State& state) {
  return {static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
}

void build_mesh(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(make_mesh(size_of(state)));
}

void count_border(benchmark::State& state) {
  const WarpMesh mesh = make_mesh(size_of(state));
  for (auto _ : state) benchmark::DoNotOptimize(count_border_pixels(mesh));
}

void run(benchmark::State& state, Warper& warper) {
  const ImageSize size = size_of(state);
  const VideoFrame frame = make_frame(size);
  const WarpMesh mesh = make_mesh(size);
  for (auto _ : state) benchmark::DoNotOptimize(warper.warp(frame, mesh));
  state.SetLabel(warper.renderer());
}

void warp_cpu(benchmark::State& state) {
  run(state, *make_cpu_warper());
}

void warp_gles(benchmark::State& state, GlesVersion version) {
  const auto warper = make_gles_warper(size_of(state), size_of(state), version);
  if (!warper) return state.SkipWithError(warper.error().message.c_str());
  run(state, **warper);
}

void usual_sizes(benchmark::internal::Benchmark* bench) {
  bench->Args({1280, 720})->Args({1920, 1080})->Unit(benchmark::kMillisecond);
}

BENCHMARK(build_mesh)->Apply(usual_sizes);
BENCHMARK(count_border)->Apply(usual_sizes);
BENCHMARK(warp_cpu)->Apply(usual_sizes);
// llvmpipe draws on threads of its own, so that only the process' time is what a frame costs.
BENCHMARK_CAPTURE(warp_gles, best, GlesVersion::best)->Apply(usual_sizes)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_gles, gles2, GlesVersion::gles2)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace gimbal

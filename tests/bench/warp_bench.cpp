#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstring>
#include <memory>
#include <utility>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"
#include "pipeline/warp/warper.hpp"

namespace {

using gimbal::Border;
using gimbal::ImageSize;
using gimbal::Lens;
using gimbal::LensParameters;
using gimbal::Nv12Buffer;
using gimbal::VideoFrame;
using gimbal::VirtualCamera;
using gimbal::Warper;
using gimbal::WarpMesh;

constexpr ImageSize kSize{1280, 720};

/// A 720p camera of about 60°.
Lens pinhole_lens() {
  LensParameters parameters;
  parameters.K << 1223.0, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1;
  return Lens::create(std::move(parameters)).value();
}

/// Turns by 2 rad/s while 30 ms are read.
Eigen::Quaterniond panning_camera(double line) {
  const double angle_rad = 0.06 * line / kSize.height;
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::UnitY()));
}

WarpMesh mesh_of_a_pan(const Lens& lens) {
  VirtualCamera camera;
  camera.q_world_camera = panning_camera(kSize.height / 2.0);
  camera.intrinsics = {1350, 1344, 640, 360};  // a tenth of zoom
  return gimbal::build_warp_mesh(lens, kSize, gimbal::ReadoutDirection::top_down, panning_camera,
                                 camera, kSize, Border::crop, {});
}

void mesh_720p(benchmark::State& state) {
  const Lens lens = pinhole_lens();
  for (auto _ : state) benchmark::DoNotOptimize(mesh_of_a_pan(lens));
}
BENCHMARK(mesh_720p)->Unit(benchmark::kMicrosecond);

VideoFrame grey_frame() {
  Nv12Buffer buffer(kSize);
  const auto fill = [](gimbal::MutablePlane plane, int rows) {
    std::memset(plane.data, 128, static_cast<std::size_t>(plane.stride_bytes * rows));
  };
  fill(buffer.luma(), kSize.height);
  fill(buffer.chroma(), gimbal::chroma_size(kSize).height);
  return std::move(buffer).publish({}, {});
}

void warp_frame(benchmark::State& state, Warper& warper) {
  const WarpMesh mesh = mesh_of_a_pan(pinhole_lens());
  const VideoFrame frame = grey_frame();
  for (auto _ : state) {
    if (!warper.warp(frame, mesh)) {
      state.SkipWithError("the warper failed");
      return;
    }
  }
  state.SetLabel(warper.renderer());
}

void cpu_warp_720p(benchmark::State& state) {
  warp_frame(state, *gimbal::make_cpu_warper());
}
BENCHMARK(cpu_warp_720p)->Unit(benchmark::kMicrosecond)->MeasureProcessCPUTime();

/// A software renderer draws on threads of its own: their time counts too.
void gles_warp_720p(benchmark::State& state) {
  const auto warper = gimbal::make_gles_warper(kSize, kSize);
  if (!warper) {
    state.SkipWithError(warper.error().message.c_str());
    return;
  }
  warp_frame(state, **warper);
}
BENCHMARK(gles_warp_720p)->Unit(benchmark::kMicrosecond)->MeasureProcessCPUTime();

}  // namespace

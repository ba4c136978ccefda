// What one frame costs: the mesh, the count of border pixels, each warper, and what the GLES warper
// copies; and OpenCV's remap of the same picture, whose maps are ready and in its fastest format.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pipeline/warp/draw_plane.hpp"
#include "pipeline/warp/egl_context.hpp"
#include "pipeline/warp/plane_readback.hpp"
#include "pipeline/warp/plane_upload.hpp"
#include "pipeline/warp/transfer_probe.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

PinholeIntrinsics intrinsics_of(ImageSize size) {
  return {0.955 * size.width, 0.955 * size.width, size.width / 2.0, size.height / 2.0};
}

constexpr double kUsualRoll_deg = 2;

/// A view zoomed by 1.15, rolled and panned a little while the rows are read.
WarpMesh make_mesh(ImageSize size, double roll_deg = kUsualRoll_deg) {
  const PinholeIntrinsics k = intrinsics_of(size);
  LensParameters parameters;
  parameters.K << k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1;
  const Lens lens = Lens::create(parameters).value();
  const auto q_world_camera = [&](double line) {
    return Eigen::AngleAxisd(roll_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()) *
           Eigen::Quaterniond(
               Eigen::AngleAxisd(0.03 * line / size.height, Eigen::Vector3d::UnitY()));
  };
  VirtualCamera camera;
  camera.intrinsics = {1.15 * k.fx, 1.15 * k.fy, k.cx, k.cy};
  const MeshDensity density =
      choose_mesh_density(lens, size, ReadoutDirection::top_down, q_world_camera, camera).density;
  return with_shared_error(build_warp_mesh(lens, size, ReadoutDirection::top_down, q_world_camera,
                                           camera, size, Border::crop, density));
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

/// The mesh is built anew for each frame, as it is in a run.
void run(benchmark::State& state, Warper& warper, double roll_deg = kUsualRoll_deg) {
  const ImageSize size = size_of(state);
  const VideoFrame frame = make_frame(size);
  for (auto _ : state) benchmark::DoNotOptimize(warper.warp(frame, make_mesh(size, roll_deg)));
  state.SetLabel(warper.renderer());
}

/// As many frames in flight as the warper allows.
void run_in_flight(benchmark::State& state, Warper& warper) {
  const ImageSize size = size_of(state);
  const VideoFrame frame = make_frame(size);
  std::size_t in_flight = 0;
  for (auto _ : state) {
    if (!warper.begin(frame, make_mesh(size))) return state.SkipWithError("no frame begun");
    if (++in_flight < warper.most_in_flight()) continue;
    benchmark::DoNotOptimize(warper.finish());
    --in_flight;
  }
  for (; in_flight > 0; --in_flight) benchmark::DoNotOptimize(warper.finish());
  state.SetLabel(warper.renderer());
}

void warp_cpu(benchmark::State& state, int threads, Interpolation interpolation) {
  run(state, *make_cpu_warper(threads, interpolation));
}

/// Rows of the source are crossed, so that samples have to be gathered.
void warp_cpu_rolled(benchmark::State& state, double roll_deg) {
  run(state, *make_cpu_warper(1), roll_deg);
}

void warp_gles(benchmark::State& state, GlesVersion version, Interpolation interpolation) {
  const auto warper = make_gles_warper(size_of(state), size_of(state), {interpolation, version});
  if (!warper) return state.SkipWithError(warper.error().message.c_str());
  run(state, **warper);
}

/// The way of one plane to the renderer's memory and back.
struct PlaneTransfer {
  PlaneUpload upload;
  PlaneReadback readback;
};

/// How the GLES warper would transfer planes of pictures of this size.
Result<PlaneTransfer> make_transfer(Plane plane, ImageSize size, MeshPainter& painter,
                                    int gles_version) {
  const auto way = choose_readback(painter, gles_version);
  if (!way) return tl::unexpected(way.error());
  auto readback = PlaneReadback::create(plane, size, gles_version, *way);
  if (!readback) return tl::unexpected(readback.error());
  return PlaneTransfer{PlaneUpload(plane, size, gles_version), std::move(*readback)};
}

/// The part of warp_gles that is not drawing. The picture is drawn nevertheless, since copies are
/// cheaper than in a run where nothing else goes through the caches.
void gles_transfers(benchmark::State& state) {
  const auto context = EglContext::create(GlesVersion::best);
  if (!context) return state.SkipWithError(context.error().message.c_str());
  const int gles_version = (*context)->major_version();
  auto painter = MeshPainter::create(texture_channels(gles_version), Interpolation::bilinear);
  if (!painter) return state.SkipWithError(painter.error().message.c_str());
  const ImageSize size = size_of(state);
  auto luma = make_transfer(Plane::luma, size, *painter, gles_version);
  auto chroma = make_transfer(Plane::chroma, size, *painter, gles_version);
  if (!luma || !chroma) return state.SkipWithError("the renderer cannot be read back");
  const VideoFrame frame = make_frame(size);
  const WarpMesh mesh = make_mesh(size);
  const Nv12Buffer picture(size);
  for (auto _ : state) {
    const GLuint luma_texture = luma->upload.upload(frame.planes[0]);
    const GLuint chroma_texture = chroma->upload.upload(frame.planes[1]);
    state.PauseTiming();
    draw_plane(*painter, mesh, Plane::luma, ChromaSiting::left, {},
               {luma_texture, luma->readback.framebuffer()});
    draw_plane(*painter, mesh, Plane::chroma, ChromaSiting::left, {},
               {chroma_texture, chroma->readback.framebuffer()});
    glFinish();
    state.ResumeTiming();
    luma->readback.begin(picture.luma().stride_bytes);
    chroma->readback.begin(picture.chroma().stride_bytes);
    if (!luma->readback.finish(picture.luma()) || !chroma->readback.finish(picture.chroma())) {
      return state.SkipWithError("the renderer cannot be read back");
    }
  }
}

void warp_gles_in_flight(benchmark::State& state, GlesVersion version) {
  const auto warper =
      make_gles_warper(size_of(state), size_of(state), {Interpolation::bilinear, version});
  if (!warper) return state.SkipWithError(warper.error().message.c_str());
  run_in_flight(state, **warper);
}

/// Where each pixel of one plane comes from, as OpenCV's remap has it in fixed point.
struct RemapMaps {
  cv::Mat pixels;
  cv::Mat fractions;
};

RemapMaps make_maps(const WarpMesh& mesh, ImageSize size, double scale) {
  cv::Mat map(size.height, size.width, CV_32FC2);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto source = source_of(mesh, Eigen::Vector2d(x, y) * scale);
      const Eigen::Vector2f at = source ? (*source / scale).cast<float>() : Eigen::Vector2f(-9, -9);
      map.at<cv::Vec2f>(y, x) = {at.x(), at.y()};
    }
  }
  RemapMaps maps;
  cv::convertMaps(map, {}, maps.pixels, maps.fractions, CV_16SC2);
  return maps;
}

cv::Mat picture_of(const VideoFrame& frame, std::size_t plane, ImageSize size, int type) {
  const ConstPlane& memory = frame.planes[plane];
  return cv::Mat(size.height, size.width, type, const_cast<std::uint8_t*>(memory.data),
                 static_cast<std::size_t>(memory.stride_bytes));
}

void opencv_remap(benchmark::State& state) {
  cv::setNumThreads(1);
  const ImageSize size = size_of(state);
  const VideoFrame frame = make_frame(size);
  const WarpMesh mesh = make_mesh(size);
  const RemapMaps luma_maps = make_maps(mesh, size, 1);
  const RemapMaps chroma_maps = make_maps(mesh, chroma_size(size), 2);
  const cv::Mat luma = picture_of(frame, 0, size, CV_8UC1);
  const cv::Mat chroma = picture_of(frame, 1, chroma_size(size), CV_8UC2);
  cv::Mat luma_out;
  cv::Mat chroma_out;
  for (auto _ : state) {
    cv::remap(luma, luma_out, luma_maps.pixels, luma_maps.fractions, cv::INTER_LINEAR,
              cv::BORDER_CONSTANT, 16);
    cv::remap(chroma, chroma_out, chroma_maps.pixels, chroma_maps.fractions, cv::INTER_LINEAR,
              cv::BORDER_CONSTANT, {128, 128});
    benchmark::ClobberMemory();
  }
}

void usual_sizes(benchmark::internal::Benchmark* bench) {
  bench->Args({1280, 720})->Args({1920, 1080})->Unit(benchmark::kMillisecond);
}

BENCHMARK(build_mesh)->Apply(usual_sizes);
BENCHMARK(count_border)->Apply(usual_sizes);
BENCHMARK_CAPTURE(warp_cpu, one_thread, 1, Interpolation::bilinear)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_cpu, two_threads, 2, Interpolation::bilinear)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_cpu, bicubic_one_thread, 1, Interpolation::bicubic)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_cpu_rolled, by_7_degrees, 7)->Apply(usual_sizes)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_cpu_rolled, by_30_degrees, 30)->Apply(usual_sizes)->MeasureProcessCPUTime();
BENCHMARK(opencv_remap)->Apply(usual_sizes);
// llvmpipe draws on threads of its own, so that only the process' time is what a frame costs.
BENCHMARK_CAPTURE(warp_gles, best, GlesVersion::best, Interpolation::bilinear)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_gles, bicubic, GlesVersion::best, Interpolation::bicubic)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(warp_gles, gles2, GlesVersion::gles2, Interpolation::bilinear)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime();
// Counted, since what is drawn does not count towards the least time.
BENCHMARK(gles_transfers)->Apply(usual_sizes)->MeasureProcessCPUTime()->Iterations(20);
// What counts here is the wall time.
BENCHMARK_CAPTURE(warp_gles_in_flight, best, GlesVersion::best)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(warp_gles_in_flight, gles2, GlesVersion::gles2)
    ->Apply(usual_sizes)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace gimbal

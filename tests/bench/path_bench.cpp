#include <benchmark/benchmark.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/synthetic/hand_motion.hpp"
#include "pipeline/path/camera_path.hpp"
#include "pipeline/warp/frame_outline.hpp"

namespace {

using gimbal::CameraPath;
using gimbal::FramePose;
using gimbal::ImageSize;
using gimbal::PathFrame;

constexpr ImageSize kSize{1280, 720};
constexpr gimbal::ZoomChoice kZoom = {1.15, 1.15};

gimbal::Lens pinhole() {
  gimbal::LensParameters parameters;
  parameters.K << 1220, 0, 639.5, 0, 1220, 359.5, 0, 0, 1;
  return *gimbal::Lens::create(parameters);
}

/// A minute in a walking hand, at 30 frames a second, with a global shutter.
std::vector<PathFrame> walk() {
  const gimbal::Motion motion =
      gimbal::make_hand_motion(gimbal::walking_hand(), std::chrono::minutes(1), 1);
  static const gimbal::Lens lens = pinhole();
  const gimbal::OutputProjection projection{
      gimbal::OutputLens::rectilinear, lens, {1220, 1220, 639.5, 359.5}};
  std::vector<PathFrame> frames;
  for (int i = 0; i < 1800; ++i) {
    const gimbal::SensorTime time = gimbal::time_from_seconds(i / 30.0);
    const FramePose pose{{i, time, std::nullopt}, motion.at(time).q_world_camera};
    const gimbal::FrameOutline outline = trace_outline(
        lens, kSize, gimbal::ReadoutDirection::top_down,
        [&](double) { return pose.q_world_camera; }, 17);
    const auto room = view_room(outline, pose.q_world_camera, projection, kSize);
    frames.push_back({pose, room, [outline, projection](const Eigen::Quaterniond& view) {
                        return required_zoom(outline, view, projection, kSize);
                      }});
  }
  return frames;
}

/// One frame through the path, once it holds as many as its latency has it hold. The frames start
/// again where they end, later.
void path_frame(benchmark::State& state, std::unique_ptr<CameraPath> path) {
  static const std::vector<PathFrame> frames = walk();
  std::size_t next = 0;
  const auto push_next = [&] {
    PathFrame frame = frames[next % frames.size()];
    frame.real.stamp.time += std::chrono::minutes(next / frames.size());
    path->push(std::move(frame));
    ++next;
  };
  while (next < 200) push_next();
  while (path->pop()) {
  }
  for (auto _ : state) {
    push_next();
    benchmark::DoNotOptimize(path->pop());
  }
}

void hann_path_frame(benchmark::State& state) {
  path_frame(state, gimbal::make_hann_path(99, kZoom, 50));
}
BENCHMARK(hann_path_frame);

void adaptive_hann_path_frame(benchmark::State& state) {
  path_frame(state, gimbal::make_adaptive_hann_path({}, kZoom, 50));
}
BENCHMARK(adaptive_hann_path_frame);

void bounded_path_frame(benchmark::State& state) {
  path_frame(state, gimbal::make_bounded_path({}, kZoom, static_cast<std::size_t>(state.range(0))));
}
BENCHMARK(bounded_path_frame)->ArgName("latency")->Arg(0)->Arg(5)->Arg(15)->Arg(50);

}  // namespace

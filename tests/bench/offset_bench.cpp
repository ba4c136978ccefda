// What tracking the time offset costs: the daemon takes two bursts a second at most.

#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sync/small_picture.hpp"

namespace {

using gimbal::ImageSize;
using gimbal::VideoFrame;

constexpr int kTile_px = 16;  // edges and corners everywhere
constexpr int kMove_px = 6;   // a frame
constexpr int kCorners = 40;

/// Tiles of random brightness, moved aside.
VideoFrame tiles(ImageSize size, int moved_px) {
  gimbal::Nv12Buffer picture(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto tile = static_cast<std::uint64_t>(y / kTile_px * 1000 + (x + moved_px) / kTile_px);
      picture.luma().data[y * picture.luma().stride_bytes + x] =
          static_cast<std::uint8_t>((tile * 2654435761U >> 8U) % 256);
    }
  }
  return std::move(picture).publish({}, {});
}

/// Four frames, from copying their luma to their corners' tracks.
void offset_burst(benchmark::State& state) {
  gimbal::keep_to_own_thread();
  const ImageSize size{static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
  const std::array frames = {tiles(size, 0), tiles(size, kMove_px), tiles(size, 2 * kMove_px),
                             tiles(size, 3 * kMove_px)};
  for (auto _ : state) {
    std::vector<gimbal::SmallPicture> pictures;
    for (const VideoFrame& frame : frames) {
      pictures.push_back(*gimbal::small_picture(frame, gimbal::block_for(size)));
    }
    benchmark::DoNotOptimize(gimbal::follow_burst(pictures, kCorners));
  }
}
BENCHMARK(offset_burst)->Args({1280, 720})->Args({1920, 1080})->Unit(benchmark::kMicrosecond);

}  // namespace

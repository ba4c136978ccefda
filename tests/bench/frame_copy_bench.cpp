#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstring>

#include "pipeline/sample/video_frame.hpp"

namespace {

using gimbal::ImageSize;
using gimbal::Nv12Buffer;

constexpr ImageSize kSize{1280, 720};

std::size_t plane_bytes(std::ptrdiff_t stride_bytes, int rows) {
  return static_cast<std::size_t>(stride_bytes * rows);
}

/// What moving a frame's bytes costs at least: the unit that the report counts warpers in.
void frame_copy_720p(benchmark::State& state) {
  const Nv12Buffer source(kSize);
  const Nv12Buffer target(kSize);
  const std::size_t luma_bytes = plane_bytes(source.luma().stride_bytes, kSize.height);
  const std::size_t chroma_bytes =
      plane_bytes(source.chroma().stride_bytes, gimbal::chroma_size(kSize).height);
  std::memset(source.luma().data, 1, luma_bytes);
  std::memset(source.chroma().data, 2, chroma_bytes);
  for (auto _ : state) {
    std::memcpy(target.luma().data, source.luma().data, luma_bytes);
    std::memcpy(target.chroma().data, source.chroma().data, chroma_bytes);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(frame_copy_720p)->Unit(benchmark::kMicrosecond);

}  // namespace

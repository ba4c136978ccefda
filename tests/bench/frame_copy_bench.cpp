#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstring>

#include "pipeline/sample/video_frame.hpp"

namespace {

using gimbal::ImageSize;
using gimbal::Nv12Buffer;

std::size_t plane_bytes(std::ptrdiff_t stride_bytes, int rows) {
  return static_cast<std::size_t>(stride_bytes * rows);
}

/// What moving a frame's bytes costs at least: the unit that the report counts warpers in.
void frame_copy(benchmark::State& state) {
  const ImageSize size{static_cast<int>(state.range(0)), static_cast<int>(state.range(1))};
  const Nv12Buffer source(size);
  const Nv12Buffer target(size);
  const std::size_t luma_bytes = plane_bytes(source.luma().stride_bytes, size.height);
  const std::size_t chroma_bytes =
      plane_bytes(source.chroma().stride_bytes, gimbal::chroma_size(size).height);
  std::memset(source.luma().data, 1, luma_bytes);
  std::memset(source.chroma().data, 2, chroma_bytes);
  for (auto _ : state) {
    std::memcpy(target.luma().data, source.luma().data, luma_bytes);
    std::memcpy(target.chroma().data, source.chroma().data, chroma_bytes);
    benchmark::ClobberMemory();
  }
}
BENCHMARK(frame_copy)->Args({1280, 720})->Args({1920, 1080})->Unit(benchmark::kMicrosecond);

}  // namespace

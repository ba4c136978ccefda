#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal::test {

/// A value that differs between neighbours, rows, planes and frames, inside the range of video
/// levels.
constexpr std::uint8_t sample_of(std::int64_t frame, int plane, int x, int y) {
  const auto mixed =
      static_cast<std::uint64_t>(frame * 37 + plane * 91 + x * 3 + y * 7 + x * y / 5);
  return static_cast<std::uint8_t>(16 + mixed % 220);
}

/// The samples of a whole plane, without padding: what a reader should see.
inline std::vector<std::uint8_t> packed_plane(std::int64_t frame, int plane, int row_bytes,
                                              int rows) {
  std::vector<std::uint8_t> bytes;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < row_bytes; ++x) {
      bytes.push_back(sample_of(frame, plane, x, y));
    }
  }
  return bytes;
}

inline void fill(MutablePlane plane, std::int64_t frame, int index, int row_bytes, int rows) {
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < row_bytes; ++x) {
      plane.data[y * plane.stride_bytes + x] = sample_of(frame, index, x, y);
    }
  }
}

inline VideoFrame test_picture(ImageSize size, const FrameStamp& stamp, ColorInfo color = {}) {
  Nv12Buffer buffer(size);
  const ImageSize chroma = chroma_size(size);
  fill(buffer.luma(), stamp.index, 0, size.width, size.height);
  fill(buffer.chroma(), stamp.index, 1, 2 * chroma.width, chroma.height);
  return std::move(buffer).publish(stamp, std::move(color));
}

/// Intervals that no constant rate has: 33.4 ms, 1 ms, 250 ms, ... from a late start.
inline std::vector<FrameStamp> irregular_stamps(int count) {
  constexpr std::int64_t kIntervals[] = {33'400'000, 1'000'003, 250'000'001, 33'333'333,
                                         40'123'456};
  std::vector<FrameStamp> stamps;
  SensorTime time(SensorDuration(123'456'789'012'345));
  for (int index = 0; index < count; ++index) {
    stamps.push_back({index, time, std::nullopt});
    time += SensorDuration(kIntervals[index % 5]);
  }
  return stamps;
}

}  // namespace gimbal::test

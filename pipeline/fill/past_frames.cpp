#include "pipeline/fill/past_frames.hpp"

namespace gimbal {
namespace {

constexpr std::int64_t kAll_frames = 8;
constexpr std::int64_t kSecond_frames = 16;
constexpr std::int64_t kFourth_frames = 32;

bool is_kept(std::int64_t index, std::int64_t newest) {
  const std::int64_t age = newest - index;
  if (age < 0) return false;  // a camera that began to count anew
  if (age < kAll_frames) return true;
  if (age < kSecond_frames) return index % 2 == 0;
  return age < kFourth_frames && index % 4 == 0;
}

}  // namespace

void PastFrames::push(const VideoFrame& frame) {
  frames_.push_back(frame);
  std::erase_if(frames_, [&](const VideoFrame& kept) {
    return !is_kept(kept.stamp.index, frame.stamp.index);
  });
}

}  // namespace gimbal

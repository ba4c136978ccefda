#include "pipeline/sync/offset_glide.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gimbal {
namespace {

constexpr double kSlowest = 1e-3;  // seconds a second
constexpr double kFastest = 0.25;
constexpr double kTime_s = 0.5;
constexpr double kLongestStep_s = 0.1;  // a gap between frames is no reason to jump

}  // namespace

SensorDuration OffsetGlide::towards(SensorDuration wanted, SensorTime frame) {
  const SensorTime last = std::exchange(last_, frame).value_or(frame);
  const double elapsed_s = std::clamp(to_seconds(frame - last), 0.0, kLongestStep_s);
  const double left_s = to_seconds(wanted - offset_);
  const double rate = std::clamp(std::abs(left_s) / kTime_s, kSlowest, kFastest);
  const double step_s = std::clamp(left_s, -rate * elapsed_s, rate * elapsed_s);
  offset_ += duration_from_seconds(step_s);
  return offset_;
}

}  // namespace gimbal

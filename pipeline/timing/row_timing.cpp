#include "pipeline/timing/row_timing.hpp"

#include <algorithm>

namespace gimbal {
namespace {

bool reads_backwards(ReadoutDirection direction) {
  return direction == ReadoutDirection::bottom_up || direction == ReadoutDirection::right_left;
}

/// From a stamp to the middle of the exposure of the line that is read first. A line is read when
/// its exposure ends, so from the start of readout it is half the exposure back; a stamp at the end
/// of readout is later than that by the whole readout (V4L2: start of exposure, end of frame).
SensorDuration to_first_line(TimestampReference reference, SensorDuration exposure,
                             SensorDuration readout) {
  switch (reference) {
    case TimestampReference::exposure_start:
      return exposure / 2;
    case TimestampReference::readout_end:
      return -readout - exposure / 2;
    case TimestampReference::readout_start:
      break;
  }
  return -exposure / 2;
}

}  // namespace

RowTiming::RowTiming(const CameraCalibration& camera)
    : readout_(camera.readout),
      time_offset_(camera.time_offset),
      reference_(camera.timestamp),
      direction_(camera.readout_direction),
      line_count_(gimbal::line_count(camera.size, direction_)) {}

SensorTime RowTiming::time_of_line(const FrameStamp& stamp, double line) const {
  // An unknown exposure counts as none: the stamp then stands for an instant of light.
  const SensorDuration exposure = stamp.exposure.value_or(SensorDuration::zero());
  const double clamped = std::clamp(line, -0.5, line_count_ - 0.5);
  const double lines_after_first =
      reads_backwards(direction_) ? line_count_ - 1 - clamped : clamped;
  const SensorDuration after_first =
      duration_from_seconds(to_seconds(readout_) * lines_after_first / line_count_);
  return stamp.time + stamp.clock_correction + time_offset_ +
         to_first_line(reference_, exposure, readout_) + after_first;
}

}  // namespace gimbal

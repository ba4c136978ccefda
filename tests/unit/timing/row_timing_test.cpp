#include "pipeline/timing/row_timing.hpp"

#include <gtest/gtest.h>

#include <chrono>

namespace gimbal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// 1000 rows in 30 ms: 30 µs a row; 2000 columns: 15 µs a column.
CameraCalibration camera_with(ReadoutDirection direction, TimestampReference reference) {
  CameraCalibration camera;
  camera.size = {2000, 1000};
  camera.readout = milliseconds(30);
  camera.readout_direction = direction;
  camera.timestamp = reference;
  return camera;
}

const FrameStamp kStamp{0, SensorTime(seconds(5)), milliseconds(8)};

SensorDuration after_stamp(const RowTiming& timing, double line) {
  return timing.time_of_line(kStamp, line) - kStamp.time;
}

TEST(RowTiming, MiddleOfExposureByWhatTheStampNames) {
  using enum TimestampReference;
  struct Case {
    TimestampReference reference;
    SensorDuration first_row;
  };
  for (const auto& [reference, first_row] :
       {Case{readout_start, -milliseconds(4)}, Case{exposure_start, milliseconds(4)},
        Case{readout_end, -milliseconds(34)}}) {
    const RowTiming timing(camera_with(ReadoutDirection::top_down, reference));
    EXPECT_EQ(after_stamp(timing, 0), first_row);
    EXPECT_EQ(after_stamp(timing, 500), first_row + milliseconds(15));
    EXPECT_EQ(after_stamp(timing, 0.5), first_row + microseconds(15));
  }
}

TEST(RowTiming, LineIsAPixelCoordinateInEveryDirection) {
  using enum ReadoutDirection;
  struct Case {
    ReadoutDirection direction;
    int line_count;
    double first_line;
    double tenth_line;
    SensorDuration line_time;
  };
  for (const auto& c : {Case{top_down, 1000, 0, 10, microseconds(30)},
                        Case{bottom_up, 1000, 999, 989, microseconds(30)},
                        Case{left_right, 2000, 0, 10, microseconds(15)},
                        Case{right_left, 2000, 1999, 1989, microseconds(15)}}) {
    const RowTiming timing(camera_with(c.direction, TimestampReference::readout_start));
    EXPECT_EQ(timing.line_count(), c.line_count);
    EXPECT_EQ(after_stamp(timing, c.first_line), -milliseconds(4));
    EXPECT_EQ(after_stamp(timing, c.tenth_line), -milliseconds(4) + 10 * c.line_time);
  }
}

TEST(RowTiming, AddsTheTimeOffset) {
  auto camera = camera_with(ReadoutDirection::top_down, TimestampReference::readout_start);
  camera.time_offset = -milliseconds(2);
  EXPECT_EQ(after_stamp(RowTiming(camera), 0), -milliseconds(6));
}

TEST(RowTiming, UnknownExposureCountsAsNone) {
  for (auto reference : {TimestampReference::readout_start, TimestampReference::exposure_start}) {
    const RowTiming timing(camera_with(ReadoutDirection::top_down, reference));
    EXPECT_EQ(timing.time_of_line({0, SensorTime(seconds(5)), std::nullopt}, 0),
              SensorTime(seconds(5)));
  }
}

TEST(RowTiming, StaysInsideTheFrame) {
  const RowTiming timing(
      camera_with(ReadoutDirection::top_down, TimestampReference::readout_start));
  EXPECT_EQ(after_stamp(timing, -100), after_stamp(timing, -0.5));
  EXPECT_EQ(after_stamp(timing, 1e9), after_stamp(timing, 999.5));
  EXPECT_EQ(after_stamp(timing, 999.5), -milliseconds(4) + milliseconds(30) - microseconds(15));
}

TEST(RowTiming, AClockThatHasGoneAstrayIsPutRightFrameByFrame) {
  CameraCalibration camera =
      camera_with(ReadoutDirection::top_down, TimestampReference::readout_start);
  camera.time_offset = milliseconds(-7);
  const RowTiming timing(camera);
  FrameStamp stamp = kStamp;
  stamp.clock_correction = milliseconds(3);
  EXPECT_EQ(timing.time_of_line(stamp, 500) - timing.time_of_line(kStamp, 500), milliseconds(3));
}

}  // namespace
}  // namespace gimbal

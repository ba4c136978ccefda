#pragma once

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/sensor_time.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// When each row of a frame was exposed, on the IMU's clock: thesis (2.35),
/// t(y) = t_frame + t_d + t_r y/N, where t_frame is brought from the stamp's reference instant to
/// the middle of the first row's exposure. For sensors that read columns, rows are columns.
class RowTiming {
 public:
  explicit RowTiming(const CameraCalibration& camera);

  /// Middle of the exposure of the line through `line`, a coordinate along the readout axis in
  /// pixels (y for top_down and bottom_up, x otherwise), fractions allowed, clamped to the frame.
  [[nodiscard]] SensorTime time_of_line(const FrameStamp& stamp, double line) const;

  /// Number of lines: the height, or the width for sensors that read columns.
  [[nodiscard]] int line_count() const { return line_count_; }

 private:
  SensorDuration readout_;
  SensorDuration time_offset_;
  TimestampReference reference_;
  ReadoutDirection direction_;
  int line_count_;
};

}  // namespace gimbal

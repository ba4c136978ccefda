#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/sample/sensor_time.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

enum class LensModel : std::uint8_t { pinhole, brown, fisheye };

/// `K` maps camera axes (x right, y down, z forward) to pixels whose centres have whole
/// coordinates, as OpenCV has it. `distortion`: none for a pinhole; k1 k2 p1 p2 [k3 [k4 k5 k6]] for
/// Brown-Conrady; k1 k2 k3 k4 for fisheye (Kannala-Brandt).
struct LensParameters {
  LensModel model = LensModel::pinhole;
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  std::vector<double> distortion;
};

/// Which edge of the picture is read first.
enum class ReadoutDirection : std::uint8_t { top_down, bottom_up, left_right, right_left };

/// Whether what is exposed at one instant is a row; otherwise it is a column.
constexpr bool reads_rows(ReadoutDirection direction) {
  return direction == ReadoutDirection::top_down || direction == ReadoutDirection::bottom_up;
}

/// Lines of a picture along its readout: its rows, or its columns.
constexpr int line_count(ImageSize size, ReadoutDirection direction) {
  return reads_rows(direction) ? size.height : size.width;
}

/// Which instant of a frame its stamp names.
enum class TimestampReference : std::uint8_t { readout_start, exposure_start, readout_end };

/// What must be known of a camera to put each of its rows on the IMU's clock and in its axes.
struct CameraCalibration {
  ImageSize size;
  double fps = 0;
  LensParameters lens;
  SensorDuration readout{};  ///< from the first row to one past the last
  ReadoutDirection readout_direction = ReadoutDirection::top_down;
  SensorDuration time_offset{};  ///< t_d: added to a frame's stamp to get the IMU's clock
  TimestampReference timestamp = TimestampReference::readout_start;
};

struct ImuCalibration {
  Eigen::Matrix3d R_camera_imu = Eigen::Matrix3d::Identity();  ///< v_camera = R_camera_imu v_imu
  /// How much earlier than its stamp a sample was true: the sensor's low-pass filters delay it.
  std::optional<SensorDuration> delay;
};

}  // namespace gimbal

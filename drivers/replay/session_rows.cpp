#include "drivers/replay/session_rows.hpp"

#include <fmt/format.h>

#include "drivers/replay/decimal_time.hpp"

namespace gimbal {
namespace {

std::string seconds(SensorTime time) {
  return format_seconds(time.time_since_epoch());
}

std::string vector_row(SensorTime time, const Eigen::Vector3d& v) {
  return fmt::format("{},{},{},{}\n", seconds(time), v.x(), v.y(), v.z());
}

}  // namespace

std::string session_row(const GyroSample& sample) {
  return vector_row(sample.time, sample.gyro_rad_s);
}

std::string session_row(const AccelSample& sample) {
  return vector_row(sample.time, sample.accel_m_s2);
}

std::string session_row(const FrameStamp& stamp) {
  return fmt::format("{},{},{}\n", stamp.index, seconds(stamp.time),
                     stamp.exposure ? format_seconds(*stamp.exposure) : "");
}

std::string session_row_without_exposure(const FrameStamp& stamp) {
  return fmt::format("{},{}\n", stamp.index, seconds(stamp.time));
}

}  // namespace gimbal

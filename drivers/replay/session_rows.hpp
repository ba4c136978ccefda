#pragma once

#include <string>

#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

// The lines of a session's CSV files (see SESSION_FORMAT.md), each with its line feed. Numbers come
// back from them to the bit.

inline constexpr const char* kVectorHeader = "t_s,x,y,z\n";
inline constexpr const char* kFrameHeader = "index,t_s,exposure_s\n";
inline constexpr const char* kFrameHeaderWithoutExposure = "index,t_s\n";

[[nodiscard]] std::string session_row(const GyroSample& sample);
[[nodiscard]] std::string session_row(const AccelSample& sample);
[[nodiscard]] std::string session_row(const FrameStamp& stamp);
[[nodiscard]] std::string session_row_without_exposure(const FrameStamp& stamp);

}  // namespace gimbal

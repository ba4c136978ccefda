#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/replay/session.hpp"
#include "drivers/replay/stamped_log.hpp"

namespace gimbal {

/// The logs of a recording as they were read; one without samples stands for a missing file.
struct SessionLogs {
  GyroLog gyro;
  AccelLog accel;
  FrameLog frames;
};

/// Reads gyro.csv, accel.csv and frames.csv of a folder, as far as they are there. Refuses a
/// gyro.csv or frames.csv without samples; an accel.csv without samples is as good as none.
[[nodiscard]] Result<SessionLogs> read_session_logs(const std::filesystem::path& folder,
                                                    double accel_to_specific_force_m_s2,
                                                    std::vector<std::string>& warnings);

/// video.mkv, video.mp4 or video.mov of a folder, the first that is there; empty if there is none.
[[nodiscard]] std::filesystem::path find_session_video(const std::filesystem::path& folder,
                                                       std::vector<std::string>& warnings);

/// Brings logs into a shape that the pipeline can use and moves them into `session`: stamps rise.
/// What was odd goes to `session.warnings`. Refuses times that are not in seconds, and frames at a
/// time when there was no gyroscope.
[[nodiscard]] Result<void> adopt_logs(SessionLogs logs, Session& session);

}  // namespace gimbal

#pragma once

#include "drivers/replay/session.hpp"
#include "drivers/replay/stamped_log.hpp"

namespace gimbal {

/// The logs of a recording as they were read; one without samples stands for a missing file.
struct SessionLogs {
  GyroLog gyro;
  AccelLog accel;
  FrameLog frames;
};

/// Brings logs into a shape that the pipeline can use and moves them into `session`: stamps rise.
/// What was odd goes to `session.warnings`. Refuses times that are not in seconds, and frames at a
/// time when there was no gyroscope.
[[nodiscard]] Result<void> adopt_logs(SessionLogs logs, Session& session);

}  // namespace gimbal

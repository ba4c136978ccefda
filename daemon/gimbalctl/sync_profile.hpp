#pragma once

#include <filesystem>

#include "daemon/gimbalctl/calibration_profile.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sync/joint_fit.hpp"

namespace gimbal {

/// What a fit that can be trusted has found, as a calibration profile.
[[nodiscard]] Result<void> write_sync_profile(const Session& session, const JointFit& fit,
                                              const ResultFiles& files);

}  // namespace gimbal

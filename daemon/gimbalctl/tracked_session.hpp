#pragma once

#include "daemon/gimbalctl/progress_bar.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sync/joint_fit.hpp"

namespace gimbal {

/// Follows corners through the whole video of a recording. Refuses one without a video or without
/// `K`. Inertial stamps are those at which the samples were true.
[[nodiscard]] Result<JointData> track_session(const Session& session, ProgressStyle progress);

}  // namespace gimbal

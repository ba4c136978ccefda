#pragma once

#include <chrono>
#include <memory>

#include "daemon/gimbalctl/simulation.hpp"
#include "drivers/replay/session.hpp"
#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/synthetic_camera.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Numbers that no option's own parser limits. Fails with the option, its value and what is
/// allowed.
[[nodiscard]] Result<void> check(const SimulationOptions& options);

/// The camera's session.toml, with what the options change; `camera` is set.
[[nodiscard]] Result<Session> load_camera(const SimulationOptions& options);

/// Frames begin one second after the clocks' zero, so that no stamp is negative.
[[nodiscard]] Result<Motion> make_motion(const SimulationOptions& options);

[[nodiscard]] Result<std::unique_ptr<SyntheticCamera>> make_camera(
    const SimulationOptions& options, const CameraCalibration& calibration,
    std::shared_ptr<const Motion> motion);

/// On from a little before the first frame to a little after the last.
[[nodiscard]] Result<std::unique_ptr<SyntheticImu>> make_imu(const SimulationOptions& options,
                                                             const ImuCalibration& calibration,
                                                             const Motion& motion);

}  // namespace gimbal

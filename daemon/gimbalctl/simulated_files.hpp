#pragma once

#include <filesystem>

#include "daemon/gimbalctl/simulation.hpp"
#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/synthetic_camera.hpp"
#include "drivers/synthetic/synthetic_imu.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Renders video.mkv, and thumbnail.jpg from the frame in the middle.
[[nodiscard]] Result<void> write_video(SyntheticCamera& camera, const SimulationOptions& options);

/// truth.csv: orientation of the IMU at the gyro's stamps, and whether it moves.
[[nodiscard]] Result<void> write_imu_truth(const SyntheticImu& imu,
                                           const Eigen::Matrix3d& R_camera_imu,
                                           const Motion& motion, const std::filesystem::path& path);

/// truth_rows.csv: orientation of the camera in the middle of the exposure of every eighth line and
/// the last, with the time on the IMU's clock.
[[nodiscard]] Result<void> write_row_truth(const SyntheticCamera& camera, const Motion& motion,
                                           const std::filesystem::path& path);

}  // namespace gimbal

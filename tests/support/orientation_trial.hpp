#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/attitude.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal::test {

/// Where the IMU truly was at a sample.
struct TrueAttitude {
  Eigen::Quaterniond q_world_imu;
  bool moves = false;  ///< what is judged is motion
};

/// A recording with known orientation.
struct OrientationTrial {
  std::string name;
  std::vector<ImuSample> samples;
  std::vector<std::optional<TrueAttitude>> truth;  ///< one a sample; none where nothing was seen
};

/// Reads gyro.csv, accel.csv (the same stamps) and truth.csv of a folder.
[[nodiscard]] OrientationTrial read_orientation_trial(const std::filesystem::path& folder);

/// Folders of the recordings whose names start with `prefix`, in order; none where there are none.
[[nodiscard]] std::vector<std::filesystem::path> orientation_trials(
    const std::filesystem::path& shared, const std::string& prefix);

}  // namespace gimbal::test

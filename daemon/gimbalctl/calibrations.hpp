#pragma once

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

// What commands are for, in the words of the program that has them and of the one that passes them
// on.
inline constexpr const char* kCalibratePurpose = "Measure what a camera or an IMU is like";
inline constexpr const char* kIntrinsicsPurpose =
    "Focal length, principal point and distortion from views of a board";
inline constexpr const char* kSyncPurpose =
    "Find time offset, readout, axes, gyro bias and focal length";

/// Each adds one of the commands below `calibrate`.
void add_calibrate_imu(CLI::App& calibrate, CommandOutcome& outcome);
/// In gimbalctl itself, and where OpenCV was not there to build with, it only says so.
void add_calibrate_intrinsics(CLI::App& calibrate, CommandOutcome& outcome);
void add_calibrate_readout(CLI::App& calibrate, CommandOutcome& outcome);

}  // namespace gimbal

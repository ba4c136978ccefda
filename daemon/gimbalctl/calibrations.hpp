#pragma once

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

/// Each adds one of the commands below `calibrate`.
void add_calibrate_imu(CLI::App& calibrate, CommandOutcome& outcome);
/// Where OpenCV was not there to build with, it only says so.
void add_calibrate_intrinsics(CLI::App& calibrate, CommandOutcome& outcome);
void add_calibrate_readout(CLI::App& calibrate, CommandOutcome& outcome);

}  // namespace gimbal

#pragma once

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

/// Each adds one of the commands below `calibrate`.
void add_calibrate_imu(CLI::App& calibrate, CommandOutcome& outcome);
void add_calibrate_readout(CLI::App& calibrate, CommandOutcome& outcome);

}  // namespace gimbal

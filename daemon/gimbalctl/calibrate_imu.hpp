#pragma once

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

void add_calibrate_imu(CLI::App& calibrate, CommandOutcome& outcome);

}  // namespace gimbal

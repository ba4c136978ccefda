#pragma once

#include <CLI/CLI.hpp>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Each function adds one subcommand to the command line. Its callback does the whole job and
/// leaves its result in `outcome`, which outlives the app.
using CommandOutcome = Result<void>;

void add_sessions_command(CLI::App& app, CommandOutcome& outcome);
void add_simulate_command(CLI::App& app, CommandOutcome& outcome);
void add_stabilize_command(CLI::App& app, CommandOutcome& outcome);
void add_orient_command(CLI::App& app, CommandOutcome& outcome);

}  // namespace gimbal

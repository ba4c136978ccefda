#pragma once

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

/// Runs what the arguments ask for: a subcommand's callback leaves its outcome in `outcome`. The
/// program's exit status; what went wrong is told in a line on standard error.
[[nodiscard]] int run_command_line(CLI::App& app, int argc, char** argv,
                                   const CommandOutcome& outcome);

}  // namespace gimbal

#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Each function adds one subcommand to the command line. Its callback does the whole job and
/// leaves its result in `outcome`, which outlives the app.
using CommandOutcome = Result<void>;

/// What an option that names one of a few things may be set to.
template <typename Value>
std::vector<std::string> names_of(const std::map<std::string, Value>& choices) {
  std::vector<std::string> names;
  names.reserve(choices.size());
  for (const auto& [name, value] : choices) names.push_back(name);
  return names;
}

/// status, set, reload and metrics: of a running daemon.
void add_live_commands(CLI::App& app, CommandOutcome& outcome);
/// calibrate imu, intrinsics and readout
void add_calibrate_command(CLI::App& app, CommandOutcome& outcome);
void add_devices_command(CLI::App& app, CommandOutcome& outcome);
void add_sessions_command(CLI::App& app, CommandOutcome& outcome);
void add_simulate_command(CLI::App& app, CommandOutcome& outcome);
void add_stabilize_command(CLI::App& app, CommandOutcome& outcome);
void add_orient_command(CLI::App& app, CommandOutcome& outcome);
/// In gimbalctl itself, and where OpenCV or Ceres was not there to build with, it only says so.
void add_sync_command(CLI::App& app, CommandOutcome& outcome);

}  // namespace gimbal

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/command_line.hpp"
#include "daemon/gimbalctl/commands.hpp"

/// The commands of gimbalctl that stand on OpenCV and Ceres, which gimbalctl becomes when one of
/// them is wanted: so that nothing else loads these libraries, or needs them installed.
int main(int argc, char** argv) {
  CLI::App app{"The calibrations that need OpenCV or Ceres", "gimbalctl"};
  app.require_subcommand(1);
  gimbal::CommandOutcome outcome;
  gimbal::add_sync_command(app, outcome);
  CLI::App* const calibrate = app.add_subcommand("calibrate", gimbal::kCalibratePurpose);
  calibrate->require_subcommand(1);
  gimbal::add_calibrate_intrinsics(*calibrate, outcome);
  return gimbal::run_command_line(app, argc, argv, outcome);
}

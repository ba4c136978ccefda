#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {

void add_calibrate_command(CLI::App& app, CommandOutcome& outcome) {
  CLI::App* const calibrate = app.add_subcommand("calibrate", kCalibratePurpose);
  calibrate->require_subcommand(1);
  add_calibrate_imu(*calibrate, outcome);
  add_calibrate_intrinsics(*calibrate, outcome);
  add_calibrate_readout(*calibrate, outcome);
}

}  // namespace gimbal

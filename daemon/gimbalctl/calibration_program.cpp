#include "daemon/gimbalctl/calibration_program.hpp"

#include <unistd.h>

#include <filesystem>
#include <string_view>

#include "daemon/companion_folders.hpp"
#include "daemon/gimbalctl/calibrations.hpp"
#include "daemon/gimbalctl/commands.hpp"

namespace gimbal {
namespace {

constexpr const char* kProgram = "gimbalctl-calibrate";

bool is_for_it(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  return command == "sync" ||
         (command == "calibrate" && argc > 2 && std::string_view(argv[2]) == "intrinsics");
}

void add_stub(CLI::App& app, const char* name, const char* purpose, CommandOutcome& outcome) {
  CLI::App* const command = app.add_subcommand(name, purpose);
  command->allow_extras();
  command->callback([command, &outcome] {
    outcome = bad_input(command->get_name() +
                        ": gimbalctl-calibrate is not installed; it comes with the package "
                        "gimbald-calibration, or with a build that has OpenCV and Ceres");
  });
}

}  // namespace

void become_calibration_program(int argc, char** argv) {
  if (!is_for_it(argc, argv)) return;
  for (const std::filesystem::path& folder : companion_folders()) {
    execv((folder / kProgram).c_str(), argv);  // returns where it is not there
  }
}

void add_sync_command(CLI::App& app, CommandOutcome& outcome) {
  add_stub(app, "sync", kSyncPurpose, outcome);
}

void add_calibrate_intrinsics(CLI::App& calibrate, CommandOutcome& outcome) {
  add_stub(calibrate, "intrinsics", kIntrinsicsPurpose, outcome);
}

}  // namespace gimbal

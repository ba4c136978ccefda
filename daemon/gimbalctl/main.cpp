#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "daemon/gimbalctl/commands.hpp"

namespace {

constexpr int kExitFailed = 1;
constexpr int kExitBadInput = 2;

int report(const gimbal::Error& error) {
  fmt::print(stderr, "gimbalctl: {}\n", error.message);
  return error.kind == gimbal::Error::Kind::bad_input ? kExitBadInput : kExitFailed;
}

/// CLI11 has a status for each kind of misuse; ours has one.
int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  fmt::print(stderr, "gimbalctl: {} (see gimbalctl --help)\n", error.what());
  return kExitBadInput;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Steady video from Linux cameras: works on recordings", "gimbalctl"};
  app.set_version_flag("--version", GIMBALD_VERSION);
  app.require_subcommand(1);
  gimbal::CommandOutcome outcome;
  gimbal::add_stabilize_command(app, outcome);
  gimbal::add_orient_command(app, outcome);
  gimbal::add_sessions_command(app, outcome);
  gimbal::add_simulate_command(app, outcome);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error);
  }
  return outcome ? 0 : report(outcome.error());
}

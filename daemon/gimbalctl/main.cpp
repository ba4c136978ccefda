#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "daemon/gimbalctl/commands.hpp"

namespace {

constexpr int kExitFailed = 1;
constexpr int kExitBadInput = 2;

/// Where standard error is closed there is nobody left to tell.
void print_line(const std::string& line) {
  static_cast<void>(std::fputs((line + "\n").c_str(), stderr));
}

int report(const gimbal::Error& error) {
  print_line("gimbalctl: " + error.message);
  return error.kind == gimbal::Error::Kind::bad_input ? kExitBadInput : kExitFailed;
}

/// CLI11 has a status for each kind of misuse; ours has one.
int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  print_line(fmt::format("gimbalctl: {} (see gimbalctl --help)", error.what()));
  return kExitBadInput;
}

gimbal::Error standard_output_error(const char* reason) {
  return {gimbal::Error::Kind::failed, fmt::format("standard output: {}", reason)};
}

/// Runs what the arguments ask for: a subcommand's callback leaves its outcome in `outcome`.
int run(CLI::App& app, int argc, char** argv, const gimbal::CommandOutcome& outcome) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error);
  } catch (const std::bad_alloc&) {
    return report({gimbal::Error::Kind::failed, "not enough memory"});
  } catch (const std::exception& error) {  // from fmt::print, for instance
    return report({gimbal::Error::Kind::failed, error.what()});
  }
  if (!outcome) return report(outcome.error());
  if (std::fflush(stdout) != 0) return report(standard_output_error(std::strerror(errno)));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  // A reader that goes away is an error to tell of, also where libraries write for us.
  std::signal(SIGPIPE, SIG_IGN);
  CLI::App app{"Steady video from Linux cameras: works on recordings, talks to gimbald",
               "gimbalctl"};
  app.set_version_flag("--version", GIMBALD_VERSION);
  app.require_subcommand(1);
  gimbal::CommandOutcome outcome;
  gimbal::add_stabilize_command(app, outcome);
  gimbal::add_orient_command(app, outcome);
  gimbal::add_sync_command(app, outcome);
  gimbal::add_calibrate_command(app, outcome);
  gimbal::add_sessions_command(app, outcome);
  gimbal::add_simulate_command(app, outcome);
  gimbal::add_devices_command(app, outcome);
#ifdef GIMBALD_HAS_CONTROL
  gimbal::add_live_commands(app, outcome);
#endif
  return run(app, argc, argv, outcome);
}

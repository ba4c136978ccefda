#include "daemon/gimbalctl/command_line.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

namespace gimbal {
namespace {

constexpr int kExitFailed = 1;
constexpr int kExitBadInput = 2;

/// Where standard error is closed there is nobody left to tell.
void print_line(const std::string& line) {
  static_cast<void>(std::fputs((line + "\n").c_str(), stderr));
}

int report(const Error& error) {
  print_line("gimbalctl: " + error.message);
  return error.kind == Error::Kind::bad_input ? kExitBadInput : kExitFailed;
}

/// CLI11 has a status for each kind of misuse; ours has one.
int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
  print_line(fmt::format("gimbalctl: {} (see gimbalctl --help)", error.what()));
  return kExitBadInput;
}

Error standard_output_error(const char* reason) {
  return {Error::Kind::failed, fmt::format("standard output: {}", reason)};
}

}  // namespace

int run_command_line(CLI::App& app, int argc, char** argv, const CommandOutcome& outcome) {
  // A reader that goes away is an error to tell of, also where libraries write for us.
  std::signal(SIGPIPE, SIG_IGN);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_usage(app, error);
  } catch (const std::bad_alloc&) {
    return report({Error::Kind::failed, "not enough memory"});
  } catch (const std::exception& error) {  // from fmt::print, for instance
    return report({Error::Kind::failed, error.what()});
  }
  if (!outcome) return report(outcome.error());
  if (std::fflush(stdout) != 0) return report(standard_output_error(std::strerror(errno)));
  return 0;
}

}  // namespace gimbal

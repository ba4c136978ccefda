#pragma once

#include <string>
#include <vector>

namespace gimbal::test {

struct ProgramRun {
  int exit_status = -1;  ///< 128 + signal if one ended it
  std::string standard_output;
  std::string standard_error;
};

/// Runs a program to its end with the given arguments and no standard input. A program that takes
/// longer than `limit_s` is killed, which shows as a status above 128.
[[nodiscard]] ProgramRun run_program(const std::vector<std::string>& command, int limit_s);

/// Lines of a text that start with `prefix`.
[[nodiscard]] std::vector<std::string> lines_starting_with(const std::string& text,
                                                           const std::string& prefix);

}  // namespace gimbal::test

#include "tests/support/run_program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/support/temporary_folder.hpp"

namespace gimbal::test {
namespace {

constexpr int kCannotRun = 127;

void redirect(int descriptor, const std::string& file, int flags) {
  constexpr mode_t kMode = 0600;
  const int opened = open(file.c_str(), flags, kMode);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(kCannotRun);
}

[[noreturn]] void become(const std::vector<std::string>& command, int limit_s,
                         const std::string& output, const std::string& errors) {
  redirect(STDIN_FILENO, "/dev/null", O_RDONLY);
  redirect(STDOUT_FILENO, output, O_WRONLY | O_CREAT | O_TRUNC);
  redirect(STDERR_FILENO, errors, O_WRONLY | O_CREAT | O_TRUNC);
  alarm(static_cast<unsigned>(limit_s));  // survives exec, and its signal ends the program
  std::vector<char*> arguments;
  for (const std::string& argument : command) {
    arguments.push_back(const_cast<char*>(argument.c_str()));
  }
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  _exit(kCannotRun);
}

std::string content_of(const std::string& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

}  // namespace

ProgramRun run_program(const std::vector<std::string>& command, int limit_s) {
  const TemporaryFolder folder;
  const std::string output = (folder.path() / "stdout").string();
  const std::string errors = (folder.path() / "stderr").string();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork");
  if (child == 0) become(command, limit_s, output, errors);
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid");
  ProgramRun run;
  constexpr int kSignalled = 128;
  run.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : kSignalled + WTERMSIG(status);
  run.standard_output = content_of(output);
  run.standard_error = content_of(errors);
  return run;
}

std::vector<std::string> lines_starting_with(const std::string& text, const std::string& prefix) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(prefix)) lines.push_back(line);
  }
  return lines;
}

}  // namespace gimbal::test

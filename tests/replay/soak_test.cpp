// Whether the daemon could run for ever: its memory and its descriptors while it plays a recording
// over and over. Takes twenty minutes, so that only `./dev soak` runs it. Wants a machine that is
// idle otherwise: pools keep what a hiccup made them grow to, a picture of 1.4 MB for each frame.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;

constexpr minutes kWarmUp{2};
constexpr minutes kEnd{20};
constexpr seconds kLook{10};
constexpr double kFlat = 0.02;
constexpr int kSimulationLimit_s = 1000;

/// A program that runs beside the test and ends with it.
class Program {
 public:
  explicit Program(std::vector<std::string> command) {
    std::vector<char*> arguments;
    for (std::string& argument : command) arguments.push_back(argument.data());
    arguments.push_back(nullptr);
    if (::posix_spawn(&pid_, arguments[0], nullptr, nullptr, arguments.data(), environ) != 0) {
      pid_ = -1;
    }
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() {
    if (pid_ > 0) static_cast<void>(end());
  }

  [[nodiscard]] bool is_running() const {
    return pid_ > 0 && ::waitpid(pid_, nullptr, WNOHANG) == 0;
  }

  /// Its exit status; 128 + signal if one ended it.
  [[nodiscard]] int end() {
    int status = 0;
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  /// What of its memory is in RAM, libraries' included. 0 if that cannot be read.
  [[nodiscard]] double resident_mb() const {
    std::ifstream file(proc() / "smaps_rollup");  // what /proc/PID/status says is not exact
    for (std::string word; file >> word;) {
      double kib = 0;
      if (word == "Rss:" && file >> kib) return kib * 1024 / 1e6;
    }
    return 0;
  }

  [[nodiscard]] double descriptors() const {
    return static_cast<double>(
        std::distance(std::filesystem::directory_iterator(proc() / "fd"), {}));
  }

 private:
  [[nodiscard]] std::filesystem::path proc() const {
    return std::filesystem::path("/proc") / std::to_string(pid_);
  }

  pid_t pid_ = -1;
};

/// Says how far off its median a series goes, as a share of it.
double deviation(const char* name, std::vector<double> series) {
  std::ranges::sort(series);
  const double median = series[series.size() / 2];
  const double largest = std::max(series.back() - median, median - series.front()) / median;
  fmt::print("{}: median {:.1f}, {:.1f} to {:.1f}: {:.2f} % off at most\n", name, median,
             series.front(), series.back(), 100 * largest);
  return largest;
}

TEST(Soak, MemoryAndDescriptorsStayFlat) {
  const test::TemporaryFolder folder;
  const std::string session = (folder.path() / "session").string();
  const auto simulated = test::run_program(
      {GIMBALCTL, "simulate", "-o", session, "--size", "1280x720", "--fps", "30", "--quiet"},
      kSimulationLimit_s);
  ASSERT_EQ(simulated.exit_status, 0) << simulated.standard_error;
  folder.write("gimbald.toml",
               fmt::format("outputs = [\"queue ! fakesink\"]\n[replay]\nsession = \"{}\"\n"
                           "repeat = true\n[stabilization]\nlatency_frames = 5\nwarper = \"cpu\"\n"
                           "[control]\nsocket = \"\"\n",
                           session));
  const auto begin = std::chrono::steady_clock::now();
  Program daemon({GIMBALD, "--config", (folder.path() / "gimbald.toml").string()});
  std::vector<double> memory_mb;
  std::vector<double> descriptors;
  for (auto at = begin + kWarmUp; at <= begin + kEnd; at += kLook) {
    std::this_thread::sleep_until(at);
    ASSERT_TRUE(daemon.is_running());
    memory_mb.push_back(daemon.resident_mb());
    descriptors.push_back(daemon.descriptors());
    fmt::print("{} s: {:.1f} MB, {} descriptors\n",
               std::chrono::duration_cast<seconds>(at - begin).count(), memory_mb.back(),
               descriptors.back());
    std::fflush(stdout);
  }
  EXPECT_EQ(daemon.end(), 0);
  EXPECT_LE(deviation("memory in MB", memory_mb), kFlat);
  EXPECT_LE(deviation("descriptors", descriptors), kFlat);
}

}  // namespace
}  // namespace gimbal

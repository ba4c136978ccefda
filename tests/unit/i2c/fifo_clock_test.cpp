#include "drivers/i2c/fifo_clock.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <ostream>
#include <random>
#include <string>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::hours;

/// A chip, its bus and the thread that empties its FIFO.
struct Simulation {
  const char* name;
  double nominal_hz;
  double rate_error;   ///< of the chip's oscillator
  double drift_per_s;  ///< of its period, with temperature
  double drain_every_s;
  double usual_delay_s;   ///< of the thread, in the mean
  double seldom_delay_s;  ///< in one of twenty drains, in the mean
  double transfer_s;      ///< to read the count, shortest
};

void PrintTo(const Simulation& simulation, std::ostream* out) {
  *out << simulation.name;
}

struct Outcome {
  double rms_s = 0;
  double worst_s = 0;
  double period_error = 0;
  bool is_rising = true;
  int stamps = 0;
};

constexpr SensorTime kStart{hours(20)};
constexpr double kConverged_s = 3;

SensorTime at(double time_s) {
  return kStart + duration_from_seconds(time_s);
}

class Chip {
 public:
  explicit Chip(const Simulation& it)
      : period_s_(1 / (it.nominal_hz * (1 + it.rate_error))), drift_(it.drift_per_s) {}

  /// Of sample `k`, from the first after the start.
  [[nodiscard]] double instant(double k) const {
    const double time_s = 0.0123 + k * period_s_;
    return time_s + drift_ * time_s * time_s / 2;
  }

  [[nodiscard]] int produced(double time_s) const {
    auto count = static_cast<int>(time_s / period_s_);
    while (count > 0 && instant(count - 1) > time_s) --count;
    while (instant(count) <= time_s) ++count;
    return count;
  }

 private:
  double period_s_;
  double drift_;
};

/// Thirty seconds, with the FIFO emptied unread at the tenth.
Outcome run(const Simulation& it) {
  std::mt19937 random(11);
  std::exponential_distribution<double> usual(1 / it.usual_delay_s);
  std::exponential_distribution<double> seldom(1 / it.seldom_delay_s);
  std::uniform_real_distribution<double> share(0, 1);
  const Chip chip(it);
  FifoClock clock(duration_from_seconds(1 / it.nominal_hz));
  Outcome outcome;
  double sum = 0;
  int drained = 0;
  bool has_overflowed = false;
  SensorTime last;
  double plan_s = 0;
  while (plan_s < 30) {
    plan_s += it.drain_every_s + share(random) / it.nominal_hz;
    const double asked_s = plan_s + usual(random) + (share(random) < 0.05 ? seldom(random) : 0);
    const double latched_s = asked_s + it.transfer_s * (0.3 + 0.4 * share(random));
    const double answered_s = latched_s + it.transfer_s * 0.3 + usual(random) / 10;
    plan_s = std::max(plan_s, answered_s);
    const int produced = chip.produced(latched_s);
    if (!has_overflowed && plan_s > 10) {
      has_overflowed = true;
      drained = produced;
      clock.restart();
      continue;
    }
    clock.observe(at(asked_s), at(answered_s), static_cast<std::uint64_t>(produced - drained));
    for (; drained < produced; ++drained) {
      const SensorTime stamp = clock.take();
      outcome.is_rising = outcome.is_rising && stamp > last;
      last = stamp;
      const double truth_s = chip.instant(drained);
      const bool is_converged =
          (truth_s > kConverged_s && truth_s < 10) || truth_s > 10 + kConverged_s;
      if (!is_converged) continue;
      const double error_s = to_seconds(stamp - at(truth_s));
      sum += error_s * error_s;
      outcome.worst_s = std::max(outcome.worst_s, std::abs(error_s));
      ++outcome.stamps;
    }
  }
  outcome.rms_s = std::sqrt(sum / outcome.stamps);
  const double truth_s = chip.instant(chip.produced(30)) - chip.instant(chip.produced(30) - 1);
  outcome.period_error = clock.period_s() / truth_s - 1;
  return outcome;
}

class FifoClockTest : public ::testing::TestWithParam<Simulation> {};

TEST_P(FifoClockTest, StampsAreWithin100MicrosecondsOfTheTruth) {
  const Outcome outcome = run(GetParam());
  RecordProperty("rms_us", std::to_string(1e6 * outcome.rms_s));
  RecordProperty("worst_us", std::to_string(1e6 * outcome.worst_s));
  EXPECT_GT(outcome.stamps, 1000);
  EXPECT_LT(outcome.rms_s, 100e-6);
  EXPECT_LT(outcome.worst_s, 300e-6);
  EXPECT_TRUE(outcome.is_rising);
  EXPECT_LT(std::abs(outcome.period_error), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(
    Chips, FifoClockTest,
    ::testing::Values(Simulation{"AsPromised", 1000, 0, 0, 0.005, 100e-6, 4e-3, 150e-6},
                      Simulation{"Fast", 1000, 0.02, 0, 0.005, 100e-6, 4e-3, 150e-6},
                      Simulation{"Slow", 1000, -0.02, 0, 0.005, 100e-6, 4e-3, 150e-6},
                      Simulation{"LowRate", 200, 0.02, 0, 0.01, 100e-6, 4e-3, 150e-6},
                      Simulation{"Bursts", 1000, -0.013, 0, 0.05, 500e-6, 8e-3, 150e-6},
                      Simulation{"BusyMachine", 500, 0.017, 0, 0.005, 2e-3, 20e-3, 300e-6},
                      Simulation{"Warming", 1000, 0.01, 1e-6, 0.005, 100e-6, 4e-3, 150e-6}),
    [](const auto& it) -> std::string { return it.param.name; });

TEST(FifoClockStart, StampsLieBeforeTheAnswerFromTheFirstOn) {
  FifoClock clock(duration_from_seconds(0.001));
  clock.observe(at(0.005), at(0.0052), 5);
  for (int i = 0; i < 5; ++i) {
    const SensorTime stamp = clock.take();
    EXPECT_LT(stamp, at(0.0052));
    EXPECT_GT(stamp, at(-0.001));
  }
}

TEST(FifoClockStart, TellsHowManyAnOverflowHasCost) {
  FifoClock clock(duration_from_seconds(0.001));
  for (int i = 1; i <= 1000; ++i) {
    clock.observe(at(0.001 * i + 0.0004), at(0.001 * i + 0.0006), 1);
    [[maybe_unused]] const auto stamp = clock.take();
  }
  const auto lost = static_cast<double>(clock.waiting_at(at(1.0 + 0.5)));
  EXPECT_NEAR(lost, 500, 2);
}

}  // namespace
}  // namespace gimbal

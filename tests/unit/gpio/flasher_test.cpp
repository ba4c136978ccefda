#include "drivers/gpio/flasher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

/// What was set, and when.
struct Wire {
  struct Change {
    GpioLevel level;
    SensorTime time;
  };
  std::mutex mutex;
  std::vector<Change> changes;
  std::size_t fails_after = SIZE_MAX;
};

class FakeLight final : public GpioOutput {
 public:
  explicit FakeLight(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}
  Result<void> set(GpioLevel level) override {
    const std::lock_guard lock(wire_->mutex);
    if (wire_->changes.size() >= wire_->fails_after) return failed("the chip is gone");
    wire_->changes.push_back({level, monotonic_now()});
    return {};
  }

 private:
  std::shared_ptr<Wire> wire_;
};

std::unique_ptr<Flasher> flash(const std::shared_ptr<Wire>& wire, double hz) {
  auto flasher = Flasher::start(std::make_unique<FakeLight>(wire), hz);
  EXPECT_TRUE(flasher);
  return flasher ? std::move(*flasher) : nullptr;
}

void wait_for_flashes(const Flasher& flasher, std::uint64_t flashes) {
  while (flasher.record().flashes < flashes && !flasher.record().failure) {
    std::this_thread::sleep_for(milliseconds(1));
  }
}

/// However late single changes come, lateness does not add up.
TEST(Flasher, KeepsItsFrequency) {
  constexpr double kHalf_s = 0.5 / 50;
  const auto wire = std::make_shared<Wire>();
  const auto flasher = flash(wire, 50);
  wait_for_flashes(*flasher, 20);
  const Flasher::Record record = flasher->record();
  const std::lock_guard lock(wire->mutex);
  const double elapsed_s = to_seconds(wire->changes.back().time - wire->changes.front().time);
  const auto halves = static_cast<double>(wire->changes.size() - 1);
  const auto skipped = static_cast<double>(record.skipped);
  EXPECT_GE(elapsed_s, halves * kHalf_s - to_seconds(record.latest));
  EXPECT_LE(elapsed_s, (halves + skipped) * kHalf_s + to_seconds(record.latest));
}

TEST(Flasher, IsOnAndOffInTurnAndOffInTheEnd) {
  const auto wire = std::make_shared<Wire>();
  wait_for_flashes(*flash(wire, 200), 5);
  const auto on = std::ranges::count(wire->changes, GpioLevel::active, &Wire::Change::level);
  EXPECT_GE(on, 5);
  EXPECT_GT(std::ssize(wire->changes), on);
  EXPECT_EQ(wire->changes.back().level, GpioLevel::inactive);
}

TEST(Flasher, SaysWhenItsLineFails) {
  const auto wire = std::make_shared<Wire>();
  wire->fails_after = 4;
  const auto flasher = flash(wire, 200);
  wait_for_flashes(*flasher, 100);
  ASSERT_TRUE(flasher->record().failure);
  EXPECT_EQ(flasher->record().failure->message, "the chip is gone");
  EXPECT_EQ(flasher->record().flashes, 2U);
}

TEST(Flasher, RefusesWhatNoThreadKeepsUp) {
  for (const double hz : {0.0, -1.0, 1e6, std::nan("")}) {
    const auto flasher = Flasher::start(std::make_unique<FakeLight>(std::make_shared<Wire>()), hz);
    ASSERT_FALSE(flasher) << hz;
    EXPECT_EQ(flasher.error().kind, Error::Kind::bad_input);
  }
}

/// A slow flash does not keep who ends it waiting.
TEST(Flasher, EndsAtOnce) {
  const auto wire = std::make_shared<Wire>();
  const SensorTime begin = monotonic_now();
  wait_for_flashes(*flash(wire, 0.01), 1);
  EXPECT_LT(monotonic_now() - begin, std::chrono::seconds(20));
}

}  // namespace
}  // namespace gimbal

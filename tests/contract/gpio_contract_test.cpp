// What the lines of a chip promise, on the kernel's gpio-sim: a test sees and pulls their far end.
//   GIMBALD_TEST_GPIO_SIM=/sys/devices/platform/gpio-sim.0/gpiochip0   a simulated chip of 4 lines

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/gpio/button.hpp"
#include "drivers/gpio/flasher.hpp"
#include "drivers/gpio/gpio_edges.hpp"
#include "drivers/gpio/gpio_lines.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr unsigned kInput = 2;
constexpr unsigned kOutput = 3;

/// The far end of a simulated chip's lines; see the kernel's admin-guide/gpio/gpio-sim.
class SimulatedChip {
 public:
  explicit SimulatedChip(std::filesystem::path folder) : folder_(std::move(folder)) {}

  [[nodiscard]] GpioAddress line(unsigned number) const {
    return {folder_.filename().string(), number};
  }

  /// As if a device drove the line.
  void pull(unsigned line, GpioLevel level) const {
    write(attribute(line, "pull"), level == GpioLevel::active ? "pull-up" : "pull-down");
  }

  /// "1" for a line that is high.
  [[nodiscard]] std::string volts(unsigned line) const {
    std::string value;
    std::ifstream(attribute(line, "value")) >> value;
    return value;
  }

  /// Takes the chip from its driver, as when it is pulled out, and gives it back.
  void unplug() const { write(kDriver / "unbind", device()); }
  void plug() const { write(kDriver / "bind", device()); }

 private:
  static inline const std::filesystem::path kDriver = "/sys/bus/platform/drivers/gpio-sim";

  [[nodiscard]] std::string device() const { return folder_.parent_path().filename().string(); }
  [[nodiscard]] std::filesystem::path attribute(unsigned line, const std::string& name) const {
    return folder_ / ("sim_gpio" + std::to_string(line)) / name;
  }
  static void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream out(file);
    out << text << std::flush;
    ASSERT_TRUE(out) << "cannot write " << text << " to " << file;
  }

  std::filesystem::path folder_;
};

class GpioContract : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("GIMBALD_TEST_GPIO_SIM");
    if (folder == nullptr) GTEST_SKIP() << "GIMBALD_TEST_GPIO_SIM names no simulated chip";
    chip_ = std::make_unique<SimulatedChip>(folder);
  }

  [[nodiscard]] std::unique_ptr<GpioOutput> open_output(GpioPolarity polarity) const {
    auto output = GpioOutput::open({.address = chip_->line(kOutput), .polarity = polarity});
    EXPECT_TRUE(output) << output.error().message;
    return output ? *std::move(output) : nullptr;
  }

  /// As libgpiod 2.x does; the line is low before and after.
  [[nodiscard]] bool numbers_edges() const {
    const auto input = GpioInput::open({.address = chip_->line(kInput)});
    EXPECT_TRUE(input);
    if (!input) return false;
    chip_->pull(kInput, GpioLevel::active);
    const auto edges = (*input)->read();
    chip_->pull(kInput, GpioLevel::inactive);
    return edges && edges->front().sequence.has_value();
  }

  static SensorTime plenty() { return monotonic_now() + seconds(30); }

  std::unique_ptr<SimulatedChip> chip_;
};

// --- a line that is driven -----------------------------------------------------------------------

TEST_F(GpioContract, AnOutputBeginsInactiveAndFollowsWhatIsSet) {
  chip_->pull(kOutput, GpioLevel::active);  // so that low is not what it would be by itself
  const auto output = open_output(GpioPolarity::active_high);
  ASSERT_TRUE(output);
  EXPECT_EQ(chip_->volts(kOutput), "0");
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(output->set(GpioLevel::active));
    EXPECT_EQ(chip_->volts(kOutput), "1");
    ASSERT_TRUE(output->set(GpioLevel::inactive));
    EXPECT_EQ(chip_->volts(kOutput), "0");
  }
}

TEST_F(GpioContract, AnOutputThatIsActiveLowIsHighUntilItIsSet) {
  const auto output = open_output(GpioPolarity::active_low);
  ASSERT_TRUE(output);
  EXPECT_EQ(chip_->volts(kOutput), "1");
  ASSERT_TRUE(output->set(GpioLevel::active));
  EXPECT_EQ(chip_->volts(kOutput), "0");
}

TEST_F(GpioContract, ALightFlashes) {
  auto flasher = Flasher::start(open_output(GpioPolarity::active_high), 20);
  ASSERT_TRUE(flasher);
  const SensorTime end = plenty();
  for (const char* const level : {"1", "0", "1", "0"}) {
    while (chip_->volts(kOutput) != level && monotonic_now() < end) {
      std::this_thread::sleep_for(milliseconds(1));
    }
    ASSERT_LT(monotonic_now(), end) << "never " << level;
  }
  EXPECT_FALSE((*flasher)->record().failure);
  EXPECT_GE((*flasher)->record().flashes, 2U);
}

TEST_F(GpioContract, ALineIsHeldUntilItsOwnerGoes) {
  auto output = open_output(GpioPolarity::active_high);
  const auto second = GpioOutput::open({.address = chip_->line(kOutput)});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, Error::Kind::bad_input);
  EXPECT_NE(second.error().message.find("another program or a kernel driver holds the line"),
            std::string::npos)
      << second.error().message;
  output.reset();
  EXPECT_TRUE(GpioOutput::open({.address = chip_->line(kOutput)}));
}

TEST_F(GpioContract, ALineThatTheChipHasNotIsRefused) {
  const auto output = GpioOutput::open({.address = chip_->line(99)});
  const auto input = GpioInput::open({.address = chip_->line(99)});
  ASSERT_FALSE(output);
  ASSERT_FALSE(input);
  EXPECT_EQ(output.error().kind, Error::Kind::bad_input);
  EXPECT_EQ(output.error().message, input.error().message);
  EXPECT_NE(output.error().message.find(":99: there is no such line"), std::string::npos)
      << output.error().message;
}

// --- a line that is watched ----------------------------------------------------------------------

TEST_F(GpioContract, EdgesComeInOrderWithTheKernelsStamps) {
  chip_->pull(kInput, GpioLevel::inactive);
  const auto edges = open_gpio_edges({.address = chip_->line(kInput)});
  const auto started = edges->start();
  ASSERT_TRUE(started) << started.error().message;
  for (std::uint64_t i = 1; i <= 6; ++i) {
    const bool is_rising = i % 2 == 1;
    const SensorTime before = monotonic_now();
    chip_->pull(kInput, is_rising ? GpioLevel::active : GpioLevel::inactive);
    const auto edge = edges->read_until(plenty());
    const SensorTime after = monotonic_now();
    ASSERT_TRUE(edge) << edge.error().message;
    ASSERT_TRUE(*edge);
    EXPECT_EQ((*edge)->direction, is_rising ? EdgeDirection::rising : EdgeDirection::falling);
    EXPECT_EQ((*edge)->sequence, i);
    EXPECT_GE((*edge)->time, before);
    EXPECT_LE((*edge)->time, after);
  }
  EXPECT_EQ(edges->lost(), 0U);
}

TEST_F(GpioContract, AnActiveLowLineRisesWhenItIsPulledDown) {
  chip_->pull(kInput, GpioLevel::active);
  const auto edges = open_gpio_edges({.address = chip_->line(kInput),
                                      .edges = GpioEdges::rising,
                                      .polarity = GpioPolarity::active_low});
  ASSERT_TRUE(edges->start());
  chip_->pull(kInput, GpioLevel::inactive);
  chip_->pull(kInput, GpioLevel::active);  // falls: not asked for
  const auto edge = edges->read_until(plenty());
  const auto none = edges->read_until(monotonic_now() + milliseconds(100));
  ASSERT_TRUE(edge && *edge);
  EXPECT_EQ((*edge)->direction, EdgeDirection::rising);
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

/// More than a second late: the kernel holds 16 edges for libgpiod 1.x, and drops the newest
/// unseen. For 2.x it holds 256, drops the oldest, and numbers all.
TEST_F(GpioContract, ALateReaderGetsWhatIsLeftAndKnowsWhatIsLost) {
  constexpr int kPulls = 1200;
  chip_->pull(kInput, GpioLevel::inactive);
  const bool are_numbered = numbers_edges();
  const auto edges = open_gpio_edges({.address = chip_->line(kInput)});
  ASSERT_TRUE(edges->start());
  for (int i = 0; i < kPulls; ++i) {
    chip_->pull(kInput, i % 2 == 0 ? GpioLevel::active : GpioLevel::inactive);
    std::this_thread::sleep_for(milliseconds(1));
  }
  const auto first = edges->read_until(plenty());
  ASSERT_TRUE(first) << first.error().message;
  ASSERT_TRUE(*first);
  std::uint64_t read = 1;
  for (auto edge = first; (edge = edges->read_until(monotonic_now())) && *edge;) ++read;
  EXPECT_EQ(read, are_numbered ? 256U : 16U);
  EXPECT_EQ((*first)->sequence, edges->lost() + 1);
  EXPECT_EQ(edges->lost() > 0, are_numbered);
  EXPECT_LE(read + edges->lost(), static_cast<std::uint64_t>(kPulls));
}

/// The usual wiring: from the line to ground, pulled up by the chip.
TEST_F(GpioContract, AButtonToGroundIsPressedOnce) {
  chip_->pull(kInput, GpioLevel::inactive);  // until the bias pulls it up
  Button button(open_gpio_edges({.address = chip_->line(kInput),
                                 .bias = GpioBias::pull_up,
                                 .polarity = GpioPolarity::active_low}));
  const auto started = button.start();
  ASSERT_TRUE(started) << started.error().message;
  EXPECT_EQ(chip_->volts(kInput), "1") << "nothing pulls the line up";
  chip_->pull(kInput, GpioLevel::inactive);
  const auto press = button.wait_for_press(plenty());
  ASSERT_TRUE(press) << press.error().message;
  EXPECT_TRUE(*press);
  chip_->pull(kInput, GpioLevel::active);
  const auto release = button.wait_for_press(monotonic_now() + milliseconds(200));
  ASSERT_TRUE(release);
  EXPECT_FALSE(*release);
}

// --- the chip ------------------------------------------------------------------------------------

TEST_F(GpioContract, TheChipIsListed) {
  const auto reports = list_gpio_chips();
  const std::string path = "/dev/" + chip_->line(0).chip;
  const auto is_it = [&](const DeviceReport& report) { return report.address == path; };
  const auto report = std::find_if(reports.begin(), reports.end(), is_it);
  ASSERT_NE(report, reports.end());
  EXPECT_EQ(report->obstacle, "");
  EXPECT_EQ(report->details.front(), "4 lines");
}

/// The last of the tests, since the chip may have another name afterwards.
TEST_F(GpioContract, AChipThatIsGoneIsAnError) {
  const auto edges = open_gpio_edges({.address = chip_->line(kInput)});
  ASSERT_TRUE(edges->start());
  const auto output = open_output(GpioPolarity::active_high);
  ASSERT_TRUE(output);
  chip_->unplug();
  const auto edge = edges->read_until(plenty());
  const auto set = output->set(GpioLevel::active);
  chip_->plug();
  ASSERT_FALSE(edge);
  ASSERT_FALSE(set);
  EXPECT_EQ(edge.error().kind, Error::Kind::failed);
  EXPECT_EQ(set.error().kind, Error::Kind::failed);
  EXPECT_NE(set.error().message.find("the chip is gone"), std::string::npos) << set.error().message;
}

}  // namespace
}  // namespace gimbal

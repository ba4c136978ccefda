#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"
#include "drivers/gpio/button.hpp"
#include "drivers/gpio/gpio_edges.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

/// A line whose edges a test puts in; a pipe says that they wait.
class FakeLine {
 public:
  FakeLine() { EXPECT_EQ(pipe(ends_.data()), 0); }
  FakeLine(const FakeLine&) = delete;
  FakeLine& operator=(const FakeLine&) = delete;
  ~FakeLine() {
    close(ends_[0]);
    close(ends_[1]);
  }

  void put(const KernelEdge& edge) {
    const std::lock_guard lock(mutex_);
    edges_.push_back(edge);
    EXPECT_EQ(write(ends_[1], "e", 1), 1);
  }

  void unplug() {
    const std::lock_guard lock(mutex_);
    is_gone_ = true;
    EXPECT_EQ(write(ends_[1], "g", 1), 1);
  }

  [[nodiscard]] int fd() const { return ends_[0]; }

  Result<std::vector<KernelEdge>> take() {
    const std::lock_guard lock(mutex_);
    if (is_gone_) return failed("gpio gpiochip9:4: No such device");
    std::vector<KernelEdge> taken(edges_.begin(), edges_.end());
    std::array<char, 64> bytes{};
    EXPECT_GT(::read(fd(), bytes.data(), std::min(edges_.size(), bytes.size())), 0);
    edges_.clear();
    return taken;
  }

 private:
  std::array<int, 2> ends_{};
  std::mutex mutex_;
  std::deque<KernelEdge> edges_;
  bool is_gone_ = false;
};

class FakeInput final : public GpioInput {
 public:
  explicit FakeInput(std::shared_ptr<FakeLine> line) : line_(std::move(line)) {}
  [[nodiscard]] int fd() const override { return line_->fd(); }
  [[nodiscard]] Result<std::vector<KernelEdge>> read() override { return line_->take(); }

 private:
  std::shared_ptr<FakeLine> line_;
};

class GpioEdgesTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<EdgeSource> make() const {
    return open_gpio_edges({.address = {"gpiochip9", 4}}, [line = line_](const auto&) {
      return Result<std::unique_ptr<GpioInput>>(std::make_unique<FakeInput>(line));
    });
  }

  [[nodiscard]] static SensorTime soon() { return monotonic_now() + milliseconds(20); }

  std::shared_ptr<FakeLine> line_ = std::make_shared<FakeLine>();
  std::unique_ptr<EdgeSource> edges_ = make();
};

TEST_F(GpioEdgesTest, HandsOnTheKernelsStamps) {
  ASSERT_TRUE(edges_->start());
  const SensorTime time = monotonic_now();
  line_->put({time, EdgeDirection::rising, 1});
  line_->put({time + nanoseconds(1), EdgeDirection::falling, 2});
  const auto first = edges_->read_until(soon());
  const auto second = edges_->read_until(soon());
  ASSERT_TRUE(first && *first && second && *second);
  EXPECT_EQ((*first)->time, time);
  EXPECT_EQ((*first)->line, 4U);
  EXPECT_EQ((*second)->direction, EdgeDirection::falling);
  EXPECT_EQ((*second)->sequence, 2U);
}

TEST_F(GpioEdgesTest, CountsWhatTheSequenceLacks) {
  ASSERT_TRUE(edges_->start());
  const SensorTime time = monotonic_now();
  line_->put({time, EdgeDirection::rising, 3});  // the kernel dropped the oldest two
  line_->put({time + nanoseconds(1), EdgeDirection::rising, 4});
  line_->put({time + nanoseconds(2), EdgeDirection::rising, 7});
  std::vector<std::uint64_t> sequences;
  for (int i = 0; i < 3; ++i) {
    const auto edge = edges_->read_until(soon());
    ASSERT_TRUE(edge && *edge);
    sequences.push_back((*edge)->sequence);
  }
  EXPECT_EQ(sequences, (std::vector<std::uint64_t>{3, 4, 7}));
  EXPECT_EQ(edges_->lost(), 4U);
}

TEST_F(GpioEdgesTest, CountsOnWhereTheKernelsSequenceWrapsAround) {
  ASSERT_TRUE(edges_->start());
  const SensorTime time = monotonic_now();
  line_->put({time, EdgeDirection::rising, 0xffff'ffff});
  line_->put({time + nanoseconds(1), EdgeDirection::rising, 0});
  ASSERT_TRUE(edges_->read_until(soon()));
  const auto edge = edges_->read_until(soon());
  ASSERT_TRUE(edge && *edge);
  EXPECT_EQ((*edge)->sequence, 0x1'0000'0000U);
  EXPECT_EQ(edges_->lost(), 0xffff'fffeU);
}

TEST_F(GpioEdgesTest, AKernelWithoutASequenceShowsNoLoss) {
  ASSERT_TRUE(edges_->start());
  const SensorTime time = monotonic_now();
  line_->put({time, EdgeDirection::rising, {}});
  line_->put({time + nanoseconds(1), EdgeDirection::falling, {}});
  ASSERT_TRUE(edges_->read_until(soon()));
  const auto edge = edges_->read_until(soon());
  ASSERT_TRUE(edge && *edge);
  EXPECT_EQ((*edge)->sequence, 2U);
  EXPECT_EQ(edges_->lost(), 0U);
}

TEST_F(GpioEdgesTest, RefusesStampsOfAnotherClock) {
  ASSERT_TRUE(edges_->start());
  line_->put({SensorTime(std::chrono::hours(24 * 365 * 50)), EdgeDirection::rising, {}});
  const auto edge = edges_->read_until(soon());
  ASSERT_FALSE(edge);
  EXPECT_NE(edge.error().message.find("off CLOCK_MONOTONIC"), std::string::npos);
}

TEST_F(GpioEdgesTest, RefusesAStampFromBeforeTheRequest) {
  const SensorTime before = monotonic_now();
  ASSERT_TRUE(edges_->start());
  line_->put({before - milliseconds(1), EdgeDirection::rising, 1});
  EXPECT_FALSE(edges_->read_until(soon()));
}

TEST_F(GpioEdgesTest, ALateReaderGetsWhatHasWaited) {
  ASSERT_TRUE(edges_->start());
  const SensorTime time = monotonic_now();
  line_->put({time, EdgeDirection::rising, 1});
  std::this_thread::sleep_for(milliseconds(1100));
  const auto edge = edges_->read_until(soon());
  ASSERT_TRUE(edge) << edge.error().message;
  ASSERT_TRUE(*edge);
  EXPECT_EQ((*edge)->time, time);
}

TEST_F(GpioEdgesTest, CountsAStampThatDoesNotRiseAsLost) {
  ASSERT_TRUE(edges_->start());
  const SensorTime time = monotonic_now();
  line_->put({time, EdgeDirection::rising, 1});
  line_->put({time, EdgeDirection::falling, 2});
  const auto first = edges_->read_until(soon());
  const auto none = edges_->read_until(soon());
  ASSERT_TRUE(first && *first && none);
  EXPECT_FALSE(*none);
  EXPECT_EQ(edges_->lost(), 1U);
}

TEST_F(GpioEdgesTest, ADeadlineEndsTheWait) {
  ASSERT_TRUE(edges_->start());
  const auto edge = edges_->read_until(soon());
  ASSERT_TRUE(edge);
  EXPECT_FALSE(*edge);
}

TEST_F(GpioEdgesTest, StopEndsTheWaitAndStartBeginsAnew) {
  ASSERT_TRUE(edges_->start());
  line_->put({monotonic_now(), EdgeDirection::rising, 5});
  ASSERT_TRUE(edges_->read_until(soon()));
  std::thread stopper([this] {
    std::this_thread::sleep_for(milliseconds(20));
    edges_->stop();
  });
  const auto edge = edges_->read_until(monotonic_now() + seconds(30));
  stopper.join();
  ASSERT_TRUE(edge);
  EXPECT_FALSE(*edge);
  ASSERT_TRUE(edges_->start());
  line_->put({monotonic_now(), EdgeDirection::rising, 1});  // it counts anew, too
  const auto after = edges_->read_until(soon());
  ASSERT_TRUE(after && *after);
  EXPECT_EQ((*after)->sequence, 1U);
  EXPECT_EQ(edges_->lost(), 0U);
}

TEST_F(GpioEdgesTest, AChipThatIsGoneIsAnError) {
  ASSERT_TRUE(edges_->start());
  line_->unplug();
  EXPECT_FALSE(edges_->read_until(soon()));
}

TEST(GpioAddress, ReadsChipAndLine) {
  const auto address = parse_gpio_address("gpiochip2:17");
  ASSERT_TRUE(address) << address.error().message;
  EXPECT_EQ(address->chip, "gpiochip2");
  EXPECT_EQ(address->line, 17U);
  for (const char* text : {"", "gpiochip2", "gpiochip2:", ":3", "gpiochip2:x", "gpiochip2:-1"}) {
    EXPECT_FALSE(parse_gpio_address(text)) << text;
  }
}

/// As a person who mistyped a chip reads it.
void expect_names_the_chip(const Error& error, const std::string& line, const std::string& path) {
  EXPECT_EQ(error.kind, Error::Kind::bad_input);
  EXPECT_EQ(error.message, "gpio " + line + ": " + path +
                               " is no GPIO chip; `gimbalctl devices` lists those that are there");
}

TEST(Gpio, AChipThatIsNotThereIsNamed) {
  const auto started = open_gpio_edges({.address = {"gpiochip987", 3}})->start();
  ASSERT_FALSE(started);
  expect_names_the_chip(started.error(), "gpiochip987:3", "/dev/gpiochip987");
  const auto output = GpioOutput::open({.address = {"gpiochip987", 3}});
  ASSERT_FALSE(output);
  expect_names_the_chip(output.error(), "gpiochip987:3", "/dev/gpiochip987");
}

TEST(Gpio, WhatIsNoChipIsNamed) {
  for (const std::string path : {"/dev/null", "/etc/passwd", "/dev"}) {
    const auto output = GpioOutput::open({.address = {path, 0}});
    ASSERT_FALSE(output) << path;
    expect_names_the_chip(output.error(), path + ":0", path);
  }
}

// --- the button ----------------------------------------------------------------------------------

Edge edge_at(int ms, EdgeDirection direction) {
  return {.time = SensorTime(milliseconds(ms)), .line = 0, .direction = direction, .sequence = 0};
}

/// The presses among edges that fall and rise in turn, asked every millisecond until `end_ms`.
std::vector<int> presses(const std::vector<int>& edges_ms, int end_ms) {
  Debouncer debouncer(milliseconds(20));
  std::vector<int> presses_ms;
  std::size_t next = 0;
  for (int ms = 0; ms < end_ms; ++ms) {
    for (; next < edges_ms.size() && edges_ms[next] == ms; ++next) {
      debouncer.take(edge_at(ms, next % 2 == 0 ? EdgeDirection::rising : EdgeDirection::falling));
    }
    if (const auto press = debouncer.press(SensorTime(milliseconds(ms)))) {
      presses_ms.push_back(static_cast<int>(press->time_since_epoch() / milliseconds(1)));
    }
  }
  return presses_ms;
}

TEST(Debouncer, ABouncingPressIsOne) {
  EXPECT_EQ(presses({100, 101, 103, 104, 107, 300, 301, 302, 305, 306}, 500),
            std::vector<int>{107});
}

TEST(Debouncer, ASpikeIsNone) {
  EXPECT_TRUE(presses({100, 105, 200, 219}, 500).empty());
}

TEST(Debouncer, TwoPressesAreTwo) {
  EXPECT_EQ(presses({100, 150, 200, 250}, 500), (std::vector<int>{100, 200}));
}

TEST_F(GpioEdgesTest, AButtonWaitsForItsPress) {
  Button button(std::move(edges_), milliseconds(10));
  ASSERT_TRUE(button.start());
  const SensorTime time = monotonic_now();
  std::this_thread::sleep_for(milliseconds(60));
  line_->put({time, EdgeDirection::rising, 1});
  line_->put({time + milliseconds(2), EdgeDirection::falling, 2});
  line_->put({time + milliseconds(3), EdgeDirection::rising, 3});
  line_->put({time + milliseconds(50), EdgeDirection::falling, 4});  // all before anybody asked
  const auto press = button.wait_for_press(monotonic_now() + seconds(5));
  ASSERT_TRUE(press && *press);
  EXPECT_EQ(**press, time + milliseconds(3));
  const auto none = button.wait_for_press(soon());
  ASSERT_TRUE(none);
  EXPECT_FALSE(*none);
}

}  // namespace
}  // namespace gimbal

#include "daemon/revived_source.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gimbal {
namespace {

/// Does what it is told, start by start and read by read.
class ScriptedSource {
 public:
  struct Script {
    std::deque<Result<void>> starts;
    std::deque<Result<std::optional<int>>> reads;
    std::vector<std::string> remarks;
    int stops = 0;
  };

  explicit ScriptedSource(Script& script) : script_(script) {}

  Result<void> start() {
    if (script_.starts.empty()) return {};
    return next(script_.starts);
  }
  Result<std::optional<int>> read() {
    if (script_.reads.empty()) return std::optional<int>();
    return next(script_.reads);
  }
  void stop() { ++script_.stops; }
  [[nodiscard]] std::uint64_t lost() const { return 3; }
  [[nodiscard]] std::vector<std::string> remarks() const { return script_.remarks; }

 private:
  template <typename T>
  static T next(std::deque<T>& queue) {
    T value = std::move(queue.front());
    queue.pop_front();
    return value;
  }

  Script& script_;
};

using Revived = RevivedSource<ScriptedSource, int>;

class RevivedSourceTest : public ::testing::Test {
 protected:
  ScriptedSource::Script script_;
  Revived source_{"camera", std::make_unique<ScriptedSource>(script_)};
};

TEST_F(RevivedSourceTest, HandsItemsOnUntilTheEnd) {
  script_.reads = {std::optional(1), std::optional(2)};
  EXPECT_EQ(std::get<int>(source_.read()), 1);
  EXPECT_EQ(std::get<int>(source_.read()), 2);
  EXPECT_TRUE(std::holds_alternative<SourceEnd>(source_.read()));
  EXPECT_EQ(source_.status().restarts, 0U);
}

// Such as that a recording was cut short, which nothing tells before its end.
TEST_F(RevivedSourceTest, TellsAtTheEndWhatItRemarks) {
  script_.reads = {std::optional(1)};
  EXPECT_EQ(std::get<int>(source_.read()), 1);
  script_.remarks = {"cut short"};
  ::testing::internal::CaptureStderr();
  EXPECT_TRUE(std::holds_alternative<SourceEnd>(source_.read()));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "gimbald: cut short\n");
}

TEST_F(RevivedSourceTest, SaysWhatIsWrongAndStartsAgainUntilItWorks) {
  script_.reads = {std::optional(1), failed("unplugged"), std::optional(2)};
  script_.starts.push_back(failed("not there"));
  EXPECT_EQ(std::get<int>(source_.read()), 1);
  EXPECT_TRUE(std::holds_alternative<SourceLost>(source_.read()));
  EXPECT_EQ(source_.status().obstacle, "unplugged");
  EXPECT_EQ(std::get<int>(source_.read()), 2);
  EXPECT_EQ(source_.status().obstacle, "");
  EXPECT_EQ(source_.status().restarts, 1U);
  EXPECT_EQ(source_.status().lost, 6U) << "of both starts";
  EXPECT_EQ(script_.stops, 2) << "a source is stopped before each start";
}

TEST_F(RevivedSourceTest, TellsWhatTheSourceRemarks) {
  script_.reads = {std::optional(1)};
  script_.remarks = {"imu: its clock jumped 1 time(s)"};
  ::testing::internal::CaptureStderr();
  static_cast<void>(source_.read());
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "gimbald: imu: its clock jumped 1 time(s)\n");
  EXPECT_EQ(source_.status().remarks, script_.remarks);
}

TEST_F(RevivedSourceTest, StopEndsTheWaitForItsReturn) {
  script_.reads.push_back(failed("unplugged"));
  for (int i = 0; i < 100; ++i) script_.starts.push_back(failed("not there"));
  EXPECT_TRUE(std::holds_alternative<SourceLost>(source_.read()));
  std::thread stopper([this] {
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    source_.stop();
  });
  EXPECT_TRUE(std::holds_alternative<SourceEnd>(source_.read()));
  stopper.join();
}

/// Takes its time to open, and can be stopped only then.
class SlowSource {
 public:
  Result<void> start() {
    if (starts_++ == 0) return {};
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    is_stopped_ = false;
    for (int i = 0; i < 1000 && !is_stopped_; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return {};
  }
  Result<std::optional<int>> read() { return failed("unplugged"); }
  void stop() { is_stopped_ = true; }
  [[nodiscard]] std::uint64_t lost() const { return 0; }
  [[nodiscard]] static std::vector<std::string> remarks() { return {}; }

 private:
  std::atomic<bool> is_stopped_ = false;
  int starts_ = 0;
};

TEST(RevivedSource, StopReachesASourceThatIsBeingStarted) {
  RevivedSource<SlowSource, int> source("camera", std::make_unique<SlowSource>());
  ASSERT_TRUE(source.start());
  ASSERT_TRUE(std::holds_alternative<SourceLost>(source.read()));
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(350));  // it opens from 250 on
    source.stop();
  });
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_TRUE(std::holds_alternative<SourceEnd>(source.read()));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5));
  stopper.join();
}

}  // namespace
}  // namespace gimbal

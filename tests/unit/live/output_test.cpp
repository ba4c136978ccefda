#include "daemon/output.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Opening it lasts until it is let go, as a pipe's does until somebody reads it.
class Gate {
 public:
  ~Gate() { let_go(); }
  void let_go() {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
    opened_.notify_all();
  }
  void wait() {
    std::unique_lock lock(mutex_);
    opened_.wait(lock, [this] { return is_open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable opened_;
  bool is_open_ = false;
};

class CountingSink final : public FrameSink {
 public:
  explicit CountingSink(std::shared_ptr<int> finished) : finished_(std::move(finished)) {}
  Result<void> write(const VideoFrame&) override { return {}; }
  Result<void> finish() override {
    std::this_thread::sleep_for(milliseconds(2000));  // longer than a step may last
    ++*finished_;
    return {};
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return {}; }

 private:
  std::shared_ptr<int> finished_;
};

SensorDuration since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::steady_clock::now() - begin;
}

TEST(Output, ThatCannotBeOpenedDoesNotHoldUpTheEnd) {
  const auto gate = std::make_shared<Gate>();
  Output output({"pipe", Reopening::possible,
                 [gate](const SinkFormat&) -> Result<std::unique_ptr<FrameSink>> {
                   gate->wait();
                   return failed("nobody reads it");
                 }},
                25, SensorDuration::zero());
  output.offer(VideoFrame());
  const auto begin = std::chrono::steady_clock::now();
  ::testing::internal::CaptureStderr();
  output.finish();
  EXPECT_LT(since(begin), seconds(10));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            "gimbald: output pipe: does not end, as if nobody read it; it is left as it is\n");
  EXPECT_EQ(output.written(), 0U);
  gate->let_go();
}

/// A file that can be opened from the third time on, and what then becomes of it.
OutputTarget late_file(std::shared_ptr<int> tries, std::shared_ptr<int> finished) {
  return {"film.y4m", Reopening::until_open,
          [=](const SinkFormat&) -> Result<std::unique_ptr<FrameSink>> {
            if (++*tries < 3) return bad_input("there is no folder yet");
            return std::make_unique<CountingSink>(finished);
          }};
}

TEST(Output, TriesAFileAgainThatCouldNotBeOpened) {
  const auto tries = std::make_shared<int>(0);
  const auto finished = std::make_shared<int>(0);
  Output output(late_file(tries, finished), 25, SensorDuration::zero());
  for (int i = 0; i < 1000 && output.written() == 0; ++i) {
    output.offer(VideoFrame());
    EXPECT_FALSE(output.is_gone());
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  output.finish();
  EXPECT_EQ(*tries, 3);
  EXPECT_EQ(*finished, 1);
  EXPECT_GT(output.written(), 0U);
  EXPECT_FALSE(output.is_gone());
}

TEST(Output, ThatNeverCouldBeOpenedHasFailed) {
  const auto tries = std::make_shared<int>(-1000);
  Output output(late_file(tries, std::make_shared<int>(0)), 25, SensorDuration::zero());
  output.offer(VideoFrame());
  output.finish();
  EXPECT_TRUE(output.is_gone());
}

TEST(Output, HasTimeToEndItsFile) {
  const auto finished = std::make_shared<int>(0);
  Output output({"film.mp4", Reopening::impossible,
                 [finished](const SinkFormat&) -> Result<std::unique_ptr<FrameSink>> {
                   return std::make_unique<CountingSink>(finished);
                 }},
                25, SensorDuration::zero());
  output.offer(VideoFrame());
  output.finish();
  EXPECT_EQ(*finished, 1);
  EXPECT_EQ(output.written(), 1U);
}

}  // namespace
}  // namespace gimbal

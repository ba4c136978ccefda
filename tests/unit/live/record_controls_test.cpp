#include "daemon/record_controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <thread>

#include "drivers/clock/monotonic_now.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

/// A line that a test pulls.
class FakeLine final : public EdgeSource {
 public:
  Result<void> start() override { return {}; }
  Result<std::optional<Edge>> read_until(SensorTime deadline) override {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, deadline - monotonic_now(), [this] { return !edges_.empty(); });
    if (is_broken_) return failed("the line is gone");
    if (edges_.empty()) return std::nullopt;
    const Edge edge = edges_.front();
    edges_.pop_front();
    return edge;
  }
  void stop() override {}

  void break_off() {
    const std::lock_guard lock(mutex_);
    is_broken_ = true;
  }

  void pull(EdgeDirection direction) {
    const std::lock_guard lock(mutex_);
    edges_.push_back({monotonic_now(), 0, direction, ++sequence_});
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Edge> edges_;
  bool is_broken_ = false;
  std::uint64_t sequence_ = 0;
};

class FakeLight final : public GpioOutput {
 public:
  explicit FakeLight(std::atomic<int>& changes, std::atomic<bool>& is_on)
      : changes_(changes), is_on_(is_on) {}
  Result<void> set(GpioLevel level) override {
    is_on_ = level == GpioLevel::active;
    ++changes_;
    return {};
  }

 private:
  std::atomic<int>& changes_;
  std::atomic<bool>& is_on_;
};

class RecordControlsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Session about;
    CameraCalibration camera;
    camera.size = {64, 48};
    camera.fps = 30;
    camera.lens.K << 60, 0, 31.5, 0, 60, 23.5, 0, 0, 1;
    about.camera = camera;
    RecordingSettings settings;
    settings.folder = folder_.path() / "takes";
    settings.min_free_mb = 0;
    recorder_ = std::make_unique<Recorder>(settings, CameraFormat{{64, 48}, 30, {}}, about);
    auto line = std::make_unique<FakeLine>();
    line_ = line.get();
    controls_ =
        std::make_unique<RecordControls>(std::make_unique<Button>(std::move(line)),
                                         std::make_unique<FakeLight>(changes_, is_on_), *recorder_);
  }

  static bool comes_true(const std::function<bool()>& holds) {
    for (int i = 0; i < 1000 && !holds(); ++i) std::this_thread::sleep_for(milliseconds(10));
    return holds();
  }

  /// With a contact that bounces.
  void press() const {
    for (int i = 0; i < 3; ++i) {
      line_->pull(EdgeDirection::rising);
      line_->pull(EdgeDirection::falling);
    }
    line_->pull(EdgeDirection::rising);
    std::this_thread::sleep_for(milliseconds(60));
    line_->pull(EdgeDirection::falling);
    std::this_thread::sleep_for(milliseconds(60));
  }

  test::TemporaryFolder folder_;
  std::atomic<int> changes_ = 0;
  std::atomic<bool> is_on_ = false;
  FakeLine* line_ = nullptr;
  std::unique_ptr<Recorder> recorder_;
  std::unique_ptr<RecordControls> controls_;
};

TEST_F(RecordControlsTest, APressBeginsARecordingAndTheNextEndsIt) {
  press();
  ASSERT_TRUE(comes_true([&] { return recorder_->status().is_recording; }));
  EXPECT_TRUE(comes_true([&] { return is_on_.load(); }));
  press();
  ASSERT_TRUE(comes_true([&] { return !recorder_->status().is_recording; }));
  EXPECT_TRUE(comes_true([&] { return !is_on_; }));
  EXPECT_TRUE(std::filesystem::exists(recorder_->status().folder / "session.toml"));
}

TEST_F(RecordControlsTest, WithoutItsButtonTheLightGoesOn) {
  line_->break_off();
  std::this_thread::sleep_for(milliseconds(300));
  ASSERT_TRUE(recorder_->start());
  EXPECT_TRUE(comes_true([&] { return is_on_.load(); }));
}

TEST_F(RecordControlsTest, TheLightBlinksAfterARecordingThatFailed) {
  std::filesystem::create_directories(folder_.path() / "takes");
  ASSERT_TRUE(recorder_->start());
  // The encoder is gone: pictures of another size than was said.
  Nv12Buffer picture({16, 16});
  recorder_->saw(std::move(picture).publish({0, monotonic_now(), std::nullopt}, {}));
  ASSERT_TRUE(comes_true([&] { return !recorder_->status().failure.empty(); }));
  const int before = changes_;
  EXPECT_TRUE(comes_true([&] { return changes_ > before + 3; }));
}

}  // namespace
}  // namespace gimbal

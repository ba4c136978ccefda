#include "daemon/gimbalctl/flash_recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/gpio/gpio_lines.hpp"
#include "pipeline/calibration/flashing_light.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

constexpr ImageSize kSize = {32, 240};
constexpr double kReadout_s = 0.0243;
constexpr double kExposure_s = 0.5e-3;
constexpr double kHz = 407;

/// What was set last, and whether the line was given back.
struct Wire {
  std::mutex mutex;
  GpioLevel level = GpioLevel::inactive;
  int changes = 0;
  int fails_after = 1'000'000;
  bool is_released = false;
};

class FakeLight final : public GpioOutput {
 public:
  explicit FakeLight(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}
  ~FakeLight() override { wire_->is_released = true; }
  Result<void> set(GpioLevel level) override {
    const std::lock_guard lock(wire_->mutex);
    if (wire_->changes >= wire_->fails_after) return failed("the chip is gone");
    wire_->level = level;
    ++wire_->changes;
    return {};
  }

 private:
  std::shared_ptr<Wire> wire_;
};

/// Thirty pictures a second by its stamps of a surface that a light of `kHz` shines on: what a
/// camera would see if the thread that flashes kept its times exactly.
class RollingCamera final : public CameraSource {
 public:
  explicit RollingCamera(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}

  [[nodiscard]] Result<void> start() override {
    if (is_missing) return bad_input("/dev/video9: there is no such camera");
    return {};
  }
  [[nodiscard]] CameraFormat format() const override { return {kSize, 30, {}}; }
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override {
    if (frames_ == lost_at) return failed("/dev/video9: the camera is gone");
    if (frames_ == interrupted_at) std::raise(SIGINT);
    wait_for_a_flash();
    Nv12Buffer buffer(kSize);
    const double begin_s = 5 + frames_ / 30.0;
    for (int y = 0; y < kSize.height; ++y) {
      std::fill_n(buffer.luma().data + y * buffer.luma().stride_bytes, kSize.width,
                  luma(begin_s + kReadout_s * y / kSize.height));
    }
    return std::move(buffer).publish({frames_++, SensorTime(duration_from_seconds(begin_s)), {}},
                                     {});
  }
  void stop() override { is_stopped = true; }

  bool is_missing = false;
  bool is_stopped = false;
  int lost_at = -1;
  int interrupted_at = -1;

 private:
  static std::uint8_t luma(double end_s) {
    constexpr int kSteps = 20;
    int lit = 0;
    for (int step = 0; step < kSteps; ++step) {
      lit += std::fmod((end_s - kExposure_s * step / kSteps) * kHz, 1.0) < 0.5 ? 1 : 0;
    }
    const double light = 0.1 + 0.6 * lit / kSteps;
    return static_cast<std::uint8_t>(std::lround(255 * (1.099 * std::pow(light, 0.45) - 0.099)));
  }

  /// So that the light flashes for real while pictures are taken.
  void wait_for_a_flash() const {
    if (frames_ % 10 != 0) return;
    const auto changes = [this] {
      const std::lock_guard lock(wire_->mutex);
      return wire_->changes >= wire_->fails_after ? 1'000'000 : wire_->changes;
    };
    const int before = changes();
    while (changes() < before + 2 && changes() < 1'000'000) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  std::shared_ptr<Wire> wire_;
  int frames_ = 0;
};

struct Rig {
  std::shared_ptr<Wire> wire = std::make_shared<Wire>();
  RollingCamera camera{wire};

  Result<FlashRecording> record(double hz = kHz) {
    return record_flashes(camera, std::make_unique<FakeLight>(wire), hz, ProgressStyle::quiet);
  }
  void expect_all_off() const {
    EXPECT_EQ(wire->level, GpioLevel::inactive);
    EXPECT_TRUE(wire->is_released);
    EXPECT_TRUE(camera.is_stopped);
  }
};

TEST(FlashRecording, TakesPicturesThatTellTheReadout) {
  Rig rig;
  const auto recording = rig.record();
  ASSERT_TRUE(recording) << recording.error().message;
  const FlashingLight found = measure_flashing_light(recording->profiles, kHz);
  EXPECT_EQ(found.reason, "");
  EXPECT_NEAR(found.readout_s, kReadout_s, 0.01 * kReadout_s);
  EXPECT_GT(recording->light_hz, 0);
  EXPECT_GT(rig.wire->changes, 20);
  rig.expect_all_off();
}

TEST(FlashRecording, LeavesTheLightOffWhenTheCameraGoes) {
  Rig rig;
  rig.camera.lost_at = 40;
  const auto recording = rig.record();
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().message, HasSubstr("the camera is gone"));
  rig.expect_all_off();
}

TEST(FlashRecording, LeavesTheLightOffOnASignal) {
  Rig rig;
  rig.camera.interrupted_at = 40;
  const auto recording = rig.record();
  ASSERT_FALSE(recording);
  EXPECT_THAT(recording.error().message, HasSubstr("interrupted"));
  rig.expect_all_off();
}

TEST(FlashRecording, SaysWhenTheLineFails) {
  Rig rig;
  rig.wire->fails_after = 8;
  const auto recording = rig.record();
  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().message, "the chip is gone");
  EXPECT_TRUE(rig.wire->is_released);
}

TEST(FlashRecording, DoesNotFlashWithoutACameraOrTooFast) {
  Rig missing;
  missing.camera.is_missing = true;
  EXPECT_THAT(missing.record().error().message, HasSubstr("no such camera"));
  EXPECT_EQ(missing.wire->changes, 0);
  Rig fast;
  EXPECT_EQ(fast.record(1e5).error().kind, Error::Kind::bad_input);
  EXPECT_EQ(fast.wire->changes, 0);
}

TEST(FlashRecording, RefusesALineThatThereIsNot) {
  CameraOptions camera;
  camera.camera = "/dev/no-camera";
  for (const char* const line : {"gpiochip0", "17", "no-such-chip:3"}) {
    const auto recording = record_flashes(camera, line, kHz, ProgressStyle::quiet);
    ASSERT_FALSE(recording) << line;
    EXPECT_EQ(recording.error().kind, Error::Kind::bad_input);
    EXPECT_THAT(recording.error().message, HasSubstr(line));
  }
}

}  // namespace
}  // namespace gimbal

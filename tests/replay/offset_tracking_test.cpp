// A rendered recording that is played at its own pace by a camera whose clock goes wrong: the whole
// way from pixels to the offset that frames are drawn with.

#include "daemon/offset_tracking.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "daemon/live_pipeline.hpp"
#include "drivers/replay/paced_replay.hpp"
#include "drivers/replay/session.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

constexpr double kDrift = 0.5e-3;  // 30 ms a minute
constexpr SensorDuration kCalibrationWrong = milliseconds(25);
constexpr double kSettled_s = 10;
constexpr const char* kDuration_s = "22";
constexpr double kMostWrong_s = 1.5e-3;
constexpr double kShare = 0.1;

/// Stamps fall behind: ever more has to be added to them.
class CameraWithABadClock final : public CameraSource {
 public:
  explicit CameraWithABadClock(std::unique_ptr<CameraSource> camera) : camera_(std::move(camera)) {}

  Result<void> start() override { return camera_->start(); }
  [[nodiscard]] CameraFormat format() const override { return camera_->format(); }
  void stop() override { camera_->stop(); }
  Result<std::optional<VideoFrame>> read() override {
    auto frame = camera_->read();
    if (!frame || !*frame) return frame;
    FrameStamp& stamp = (*frame)->stamp;
    if (!begin_) begin_ = stamp.time;
    const double elapsed_s = to_seconds(stamp.time - *begin_);
    elapsed_s_ = elapsed_s;
    behind_ = kCalibrationWrong + duration_from_seconds(kDrift * elapsed_s);
    stamp.time -= behind_.load();
    return frame;
  }

  [[nodiscard]] SensorDuration behind() const { return behind_; }
  [[nodiscard]] double elapsed_s() const { return elapsed_s_; }

 private:
  std::unique_ptr<CameraSource> camera_;
  std::optional<SensorTime> begin_;
  std::atomic<SensorDuration> behind_ = SensorDuration::zero();
  std::atomic<double> elapsed_s_ = 0;
};

LiveSources sources_of(const Session& session) {
  const auto timeline = std::make_shared<ReplayTimeline>(session);
  LiveSources sources;
  sources.camera = std::make_unique<CameraWithABadClock>(
      std::make_unique<PacedCamera>(session, timeline, Repeat::once));
  sources.imu = std::make_unique<PacedImu>(session, timeline, Repeat::once);
  EXPECT_TRUE(sources.camera->start());
  sources.format = sources.camera->format();
  sources.camera->stop();
  sources.camera_calibration = *session.camera;
  sources.imu_calibration = session.imu;
  return sources;
}

TEST(OffsetTrackingTest, FramesAreDrawnWithTheOffsetOfACameraWhoseClockDrifts) {
  const test::TemporaryFolder folder;
  const std::string session_folder = (folder.path() / "session").string();
  const auto simulated =
      test::run_program({GIMBALCTL, "simulate", "-o", session_folder, "--size", "480x270",
                         "--duration", kDuration_s, "--motion", "walk", "--quiet"},
                        300);
  ASSERT_EQ(simulated.exit_status, 0) << simulated.standard_error;
  const auto session = open_session(session_folder);
  ASSERT_TRUE(session) << session.error().message;
  LiveSources sources = sources_of(*session);
  const auto& camera = dynamic_cast<CameraWithABadClock&>(*sources.camera);
  const SensorDuration calibrated = sources.camera_calibration.time_offset;
  auto tracking = OffsetTracking::create(sources.camera_calibration, sources.imu_calibration,
                                         *gimbald_corner_follower(), kShare);
  ASSERT_TRUE(tracking) << tracking.error().message;
  StabilizationSettings settings;
  settings.latency = 5;
  settings.warper = WarperKind::cpu;
  auto pipeline =
      LivePipeline::start(std::move(sources), settings,
                          {TextOutput{(folder.path() / "out.y4m").string()}}, {tracking->get()});
  ASSERT_TRUE(pipeline) << pipeline.error().message;
  (*tracking)->start([&](const OffsetReport& offset) { (*pipeline)->use(offset); });
  int looks = 0;
  while (!(*pipeline)->has_ended()) {
    std::this_thread::sleep_for(milliseconds(100));
    if (camera.elapsed_s() < kSettled_s) continue;
    const double truth_s = to_seconds(calibrated + camera.behind());
    const LiveStatus status = (*pipeline)->status();
    EXPECT_NEAR(to_seconds(status.time_offset), truth_s, kMostWrong_s)
        << camera.elapsed_s() << " s";
    ++looks;
  }
  EXPECT_GT(looks, 20);
  const auto tracked = (*pipeline)->status().tracked_offset;
  ASSERT_TRUE(tracked);
  EXPECT_TRUE(tracked->estimate.is_known);
  EXPECT_LT(to_seconds(tracked->cpu_time), kShare * camera.elapsed_s());
  (*tracking)->stop();
  (*pipeline)->stop();
}

}  // namespace
}  // namespace gimbal

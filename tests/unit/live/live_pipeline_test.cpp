// The live pipeline with devices that come and go.

#include "daemon/live_pipeline.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/replay/paced_replay.hpp"
#include "pipeline/pixels/nv12_frame.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;

constexpr ImageSize kSize{64, 48};
constexpr double kFps = 50;
constexpr std::uint8_t kLevel = 150;  // of what the camera takes
constexpr std::uint8_t kGreyOfNoSignal = 64;

enum class Plug : std::uint8_t { in, out, silent };

/// A device that delivers at its rate while it is plugged in.
class Device {
 public:
  void plug(Plug plug) { plug_ = plug; }
  void stop() { is_stopped_ = true; }
  void jump_ahead_once() { jumps_ = true; }

  Result<void> start() {
    if (plug_ == Plug::out) return bad_input("not there");
    is_stopped_ = false;
    next_ = monotonic_now();
    return {};
  }

  /// Waits for the next instant of a rate; none after `stop`.
  Result<std::optional<SensorTime>> wait(SensorDuration period) {
    next_ += period;
    do {
      std::this_thread::sleep_for(
          std::max(next_ - monotonic_now(), SensorDuration(milliseconds(1))));
      if (is_stopped_) return std::nullopt;
      if (plug_ == Plug::out) return failed("unplugged");
    } while (plug_ == Plug::silent);
    const SensorTime time = std::max(next_, monotonic_now() - period);
    return jumps_.exchange(false) ? time + std::chrono::hours(1) : time;
  }

 private:
  std::atomic<Plug> plug_ = Plug::in;
  std::atomic<bool> is_stopped_ = false;
  std::atomic<bool> jumps_ = false;
  SensorTime next_;
};

class FakeCamera final : public CameraSource {
 public:
  explicit FakeCamera(Device& device) : device_(device) {}
  Result<void> start() override { return device_.start(); }
  [[nodiscard]] CameraFormat format() const override { return {kSize, kFps, {}}; }
  void ask_for(PictureForm form) override { form_ = form; }
  void stop() override { device_.stop(); }
  Result<std::optional<VideoFrame>> read() override {
    const auto time = device_.wait(duration_from_seconds(1 / kFps));
    if (!time) return tl::unexpected(time.error());
    if (!*time) return std::nullopt;
    if (form_ == PictureForm::native) return yuyv_picture({index_++, **time, std::nullopt});
    Nv12Buffer picture(kSize);
    std::fill_n(picture.luma().data, picture.luma().stride_bytes * kSize.height, kLevel);
    std::fill_n(picture.chroma().data, picture.chroma().stride_bytes * kSize.height / 2, 128);
    return std::move(picture).publish(FrameStamp{index_++, **time, std::nullopt}, {});
  }

 private:
  /// The same as one in NV12.
  static VideoFrame yuyv_picture(const FrameStamp& stamp) {
    const auto bytes = std::make_shared<std::vector<std::uint8_t>>();
    for (int i = 0; i < kSize.width * kSize.height; ++i) bytes->insert(bytes->end(), {kLevel, 128});
    VideoFrame frame;
    frame.stamp = stamp;
    frame.size = kSize;
    frame.native = NativePicture{NativeFormat::yuyv, {ConstPlane{bytes->data(), 2 * kSize.width}}};
    frame.storage = bytes;
    return frame;
  }

  Device& device_;
  PictureForm form_ = PictureForm::nv12;
  std::int64_t index_ = 0;
};

/// What the sources deliver to those who look on.
class Onlooker final : public SourceObserver {
 public:
  void saw(const VideoFrame& frame) override {
    ++(frame.native ? native : nv12);
    if (as_nv12(frame).planes[0].data[0] != kLevel) ++wrong;
  }
  void saw(const ImuReading& /*reading*/) override {}

  std::atomic<int> native = 0;
  std::atomic<int> nv12 = 0;
  std::atomic<int> wrong = 0;
};

class FakeImu final : public ImuSource {
 public:
  explicit FakeImu(Device& device) : device_(device) {}
  Result<void> start() override { return device_.start(); }
  void stop() override { device_.stop(); }
  Result<std::optional<ImuReading>> read() override {
    if (std::exchange(gives_accel_, !gives_accel_)) {
      return AccelSample{time_, Eigen::Vector3d(0, -9.81, 0)};
    }
    const auto time = device_.wait(milliseconds(5));
    if (!time) return tl::unexpected(time.error());
    if (!*time) return std::nullopt;
    time_ = **time;
    return GyroSample{time_, Eigen::Vector3d(0, 0.1, 0)};
  }

 private:
  Device& device_;
  SensorTime time_;
  bool gives_accel_ = false;
};

class LivePipelineTest : public ::testing::Test {
 protected:
  void SetUp() override { start({}); }

  struct Start {
    std::optional<GyroBias> remembered_bias;
    SensorDuration time_offset = {};
    WarperKind warper = WarperKind::cpu;
  };
  void start(const Start& given) {
    pipeline_.reset();
    LiveSources sources;
    sources.remembered_bias = given.remembered_bias;
    sources.camera_calibration.time_offset = given.time_offset;
    sources.camera = std::make_unique<FakeCamera>(camera_);
    sources.imu = std::make_unique<FakeImu>(imu_);
    sources.format = {kSize, kFps, {}};
    sources.camera_calibration.size = kSize;
    sources.camera_calibration.fps = kFps;
    sources.camera_calibration.lens.K << 60, 0, 31.5, 0, 60, 23.5, 0, 0, 1;
    sources.camera_calibration.readout = milliseconds(10);
    StabilizationSettings settings;
    settings.latency = 3;
    settings.warper = given.warper;
    settings.dma_bufs = DmaBufUse::always;  // or software renderers would want no native pictures
    settings.border = Border::extend;
    auto started =
        LivePipeline::start(std::move(sources), settings, {TextOutput{file_}}, {&onlooker_});
    ASSERT_TRUE(started) << started.error().message;
    pipeline_ = std::move(*started);
  }

  /// Waits until it holds, seconds at most.
  static bool comes_true(const std::function<bool()>& holds) {
    for (int i = 0; i < 1000; ++i) {
      if (holds()) return true;
      std::this_thread::sleep_for(milliseconds(10));
    }
    return false;
  }

  [[nodiscard]] bool frames_come() const {
    const std::uint64_t before = pipeline_->counts().frames_out;
    return comes_true([&] { return pipeline_->counts().frames_out > before + 10; });
  }

  /// The level of the first pixel of each picture that was written.
  [[nodiscard]] std::vector<std::uint8_t> written() const {
    std::ifstream file(file_, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::vector<std::uint8_t> levels;
    const std::string header = "FRAME\n";
    const auto size = static_cast<std::size_t>(kSize.width * kSize.height * 3 / 2);
    std::size_t at = bytes.find(header);
    while (at != std::string::npos && at + header.size() < bytes.size()) {
      levels.push_back(static_cast<std::uint8_t>(bytes[at + header.size()]));
      at = bytes.find(header, at + header.size() + size);
    }
    return levels;
  }

  void expect_that_frames_add_up() const {
    const LiveCounts counts = pipeline_->counts();
    EXPECT_EQ(counts.frames_in, counts.frames_out + counts.dropped_before_drawing +
                                    counts.dropped_out_of_order + counts.dropped_off_clock +
                                    counts.dropped_without_orientation);
  }

  test::TemporaryFolder folder_;
  std::string file_ = (folder_.path() / "out.y4m").string();
  Device camera_;
  Device imu_;
  Onlooker onlooker_;
  std::unique_ptr<LivePipeline> pipeline_;
};

TEST_F(LivePipelineTest, EveryFrameIsOutOrCounted) {
  ASSERT_TRUE(frames_come());
  EXPECT_TRUE(pipeline_->status().attitude);
  pipeline_->stop();
  expect_that_frames_add_up();
  EXPECT_EQ(pipeline_->counts().no_signal_pictures, 0U);
  EXPECT_EQ(written().size() + pipeline_->outputs()[0]->dropped(), pipeline_->counts().frames_out);
}

TEST_F(LivePipelineTest, ForTheCpuACameraConvertsItsPictures) {
  ASSERT_TRUE(frames_come());
  pipeline_->stop();
  EXPECT_GT(onlooker_.nv12, 10);
  EXPECT_EQ(onlooker_.native, 0);
}

TEST_F(LivePipelineTest, ToTheGpuPicturesGoAsTheCameraLaysThemOut) {
  start({{}, {}, WarperKind::gles});
  ASSERT_TRUE(frames_come());
  EXPECT_TRUE(pipeline_->transfers().starts_with("in copied YUYV, out ")) << pipeline_->transfers();
  StabilizationSettings filled;
  filled.latency = 2;
  filled.border = Border::fill;
  pipeline_->apply(filled);
  ASSERT_TRUE(frames_come());
  pipeline_->stop();
  expect_that_frames_add_up();
  EXPECT_GT(onlooker_.native, 10);
  EXPECT_EQ(onlooker_.wrong, 0);
  for (const std::uint8_t level : written()) EXPECT_EQ(level, kLevel);
}

TEST_F(LivePipelineTest, WithoutACameraThePictureSaysSoUntilItIsBack) {
  ASSERT_TRUE(frames_come());
  camera_.plug(Plug::out);
  ASSERT_TRUE(comes_true([&] { return pipeline_->counts().no_signal_pictures > 10; }));
  expect_that_frames_add_up();  // none still waits
  EXPECT_NE(pipeline_->status().camera.obstacle, "");
  camera_.plug(Plug::in);
  ASSERT_TRUE(frames_come());
  EXPECT_EQ(pipeline_->status().camera.obstacle, "");
  EXPECT_EQ(pipeline_->status().camera.restarts, 1U);
  pipeline_->stop();
  expect_that_frames_add_up();
  const std::vector<std::uint8_t> levels = written();
  EXPECT_EQ(levels.front(), kLevel);
  EXPECT_EQ(levels.back(), kLevel);
  EXPECT_GT(std::count(levels.begin(), levels.end(), kGreyOfNoSignal), 5);
}

class LivePipelineWithoutAnImu : public LivePipelineTest,
                                 public ::testing::WithParamInterface<Plug> {};

INSTANTIATE_TEST_SUITE_P(Loss, LivePipelineWithoutAnImu,
                         ::testing::Values(Plug::out, Plug::silent));

TEST_P(LivePipelineWithoutAnImu, FramesPassUntilItIsBack) {
  ASSERT_TRUE(frames_come());
  EXPECT_FALSE(pipeline_->status().is_coasting);
  imu_.plug(GetParam());
  ASSERT_TRUE(comes_true([&] { return pipeline_->status().is_coasting; }));
  ASSERT_TRUE(frames_come());
  imu_.plug(Plug::in);
  ASSERT_TRUE(comes_true([&] { return !pipeline_->status().is_coasting; }));
  ASSERT_TRUE(frames_come());
  pipeline_->stop();
  expect_that_frames_add_up();
  EXPECT_EQ(pipeline_->counts().dropped_without_orientation, 0U);
}

TEST_F(LivePipelineTest, ABiasFromTheRunBeforeCountsFromTheFirstPicture) {
  const Eigen::Vector3d bias_rad_s(0, 0.1, 0);  // the fake IMU lies still and shows this
  start({GyroBias{bias_rad_s, Eigen::Vector3d::Constant(1e-4)}});
  ASSERT_TRUE(comes_true([&] { return pipeline_->status().attitude.has_value(); }));
  const Eigen::Quaterniond first = pipeline_->status().attitude->q_world_camera;
  ASSERT_TRUE(frames_come());
  // Without it the picture turns by a degree and more meanwhile.
  EXPECT_LT(first.angularDistance(pipeline_->status().attitude->q_world_camera), 0.005);
  pipeline_->stop();
  const auto learned = pipeline_->gyro_bias();
  ASSERT_TRUE(learned);
  EXPECT_LT((learned->bias_rad_s - bias_rad_s).norm(), 0.005);
}

class LivePipelineWithClocksApart : public LivePipelineTest,
                                    public ::testing::WithParamInterface<milliseconds> {};

TEST_P(LivePipelineWithClocksApart, FramesWaitForTheirSamples) {
  start({std::nullopt, GetParam()});
  // Those from before the first sample have no orientation.
  std::this_thread::sleep_for(std::max(-GetParam(), milliseconds(0)) + milliseconds(100));
  const LiveCounts before = pipeline_->counts();
  EXPECT_TRUE(comes_true([&] { return pipeline_->counts().frames_in > before.frames_in + 60; }));
  EXPECT_TRUE(frames_come());
  const LiveStatus status = pipeline_->status();
  EXPECT_EQ(status.counts.dropped_without_orientation, before.dropped_without_orientation);
  EXPECT_FALSE(status.is_coasting);
  ASSERT_TRUE(status.attitude);
}

INSTANTIATE_TEST_SUITE_P(Offsets, LivePipelineWithClocksApart,
                         ::testing::Values(milliseconds(-1500), milliseconds(-700),
                                           milliseconds(400), milliseconds(900)),
                         [](const auto& offset) {
                           return (offset.param.count() < 0 ? "behind_by_" : "ahead_by_") +
                                  std::to_string(std::abs(offset.param.count())) + "_ms";
                         });

TEST_F(LivePipelineTest, OtherChoicesCostNoFrame) {
  ASSERT_TRUE(frames_come());
  StabilizationSettings other;
  other.amount = 0.3;
  other.latency = 6;
  other.path = PathKind::hann;
  pipeline_->apply(other);
  ASSERT_TRUE(frames_come());
  pipeline_->stop();
  expect_that_frames_add_up();
  EXPECT_EQ(pipeline_->counts().dropped_out_of_order, 0U);
}

TEST_F(LivePipelineTest, BordersAreFilledWithoutALoss) {
  for (const Border border : {Border::fill, Border::blur, Border::fill}) {
    StabilizationSettings other;
    other.latency = 2;
    other.border = border;
    pipeline_->apply(other);
    ASSERT_TRUE(frames_come());
  }
  camera_.plug(Plug::out);
  ASSERT_TRUE(comes_true([&] { return pipeline_->counts().no_signal_pictures > 10; }));
  camera_.plug(Plug::in);
  ASSERT_TRUE(frames_come());
  pipeline_->stop();
  expect_that_frames_add_up();
  for (const std::uint8_t level : written()) {
    EXPECT_TRUE(level == kLevel || level == kGreyOfNoSignal) << int{level};  // black nowhere
  }
}

TEST_F(LivePipelineTest, AFrameFromTheFutureIsLeftOutAlone) {
  ASSERT_TRUE(frames_come());
  camera_.jump_ahead_once();
  ASSERT_TRUE(comes_true([&] { return pipeline_->counts().dropped_off_clock > 0; }));
  ASSERT_TRUE(frames_come());
  pipeline_->stop();
  expect_that_frames_add_up();
  EXPECT_EQ(pipeline_->counts().dropped_off_clock, 1U);
  EXPECT_EQ(pipeline_->counts().dropped_out_of_order, 0U);
}

TEST_F(LivePipelineTest, StopsWithinTwoSecondsWhateverIsMissing) {
  camera_.plug(Plug::out);
  imu_.plug(Plug::silent);
  ASSERT_TRUE(comes_true([&] { return pipeline_->counts().no_signal_pictures > 0; }));
  const auto begin = std::chrono::steady_clock::now();
  pipeline_->stop();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

}  // namespace
}  // namespace gimbal

// What drivers/camera_source.hpp promises of a live camera, asked of every driver. Those that need
// no hardware always run; a real camera runs where the environment names one:
//   GIMBALD_TEST_V4L2=/dev/video0 GIMBALD_TEST_LIBCAMERA=ID camera_contract_test
//   GIMBALD_TEST_LIBCAMERA_FORMAT=BGR888   where the first that the camera offers does not run
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <memory>
#include <ostream>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/clock/monotonic_now.hpp"
#include "drivers/replay/paced_replay.hpp"
#include "drivers/replay/session.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"
#ifdef GIMBALD_DRIVER_LIBCAMERA
#include "drivers/libcamera/libcamera_camera.hpp"
#endif
#ifdef GIMBALD_DRIVER_V4L2
#include "drivers/v4l2/v4l2_camera.hpp"
#include "drivers/v4l2/v4l2_source.hpp"
#include "tests/support/fake_v4l2.hpp"
#endif

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using CameraOr = Result<std::unique_ptr<CameraSource>>;

/// A second at the usual rate, so that a test lasts no longer.
constexpr int kFrames = 30;

/// The kernel's vivid stamps when a picture is planned to end, up to a frame after it hands it out.
constexpr milliseconds kPlannedAhead{50};

struct LiveCamera {
  const char* name;
  /// The variable without which there is no such camera; nullptr for one that is always there.
  const char* variable;
  /// `address`: what the variable says.
  std::function<CameraOr(const std::string& address, const std::filesystem::path& folder)> open;
  /// Of its stamps, ahead of when it hands a picture out.
  milliseconds longest_ahead{1};
};

void PrintTo(const LiveCamera& camera, std::ostream* out) {
  *out << camera.name;
}

class CameraContract : public ::testing::TestWithParam<LiveCamera> {
 protected:
  void SetUp() override {
    const LiveCamera& camera = GetParam();
    const char* address = camera.variable == nullptr ? "" : std::getenv(camera.variable);
    if (address == nullptr) {
      GTEST_SKIP() << camera.variable << " names no camera: nothing to test " << camera.name
                   << " with";
    }
    auto opened = camera.open(address, folder_.path());
    ASSERT_TRUE(opened) << opened.error().message;
    camera_ = std::move(*opened);
  }

  void start() const {
    const auto started = camera_->start();
    ASSERT_TRUE(started) << started.error().message;
  }

  [[nodiscard]] std::vector<VideoFrame> read_frames(int count) const {
    std::vector<VideoFrame> frames;
    while (static_cast<int>(frames.size()) < count) {
      auto frame = camera_->read();
      if (!frame) ADD_FAILURE() << frame.error().message;
      if (!frame || !*frame) break;
      frames.push_back(**std::move(frame));
    }
    return frames;
  }

  test::TemporaryFolder folder_;
  std::unique_ptr<CameraSource> camera_;
};

TEST_P(CameraContract, FramesAreAsTheFormatSays) {
  start();
  const CameraFormat format = camera_->format();
  EXPECT_GT(format.size.width, 0);
  EXPECT_GT(format.size.height, 0);
  const auto frames = read_frames(5);
  ASSERT_EQ(frames.size(), 5U);
  for (const VideoFrame& frame : frames) {
    EXPECT_EQ(frame.size, format.size);
    EXPECT_EQ(frame.color.colorimetry, format.color.colorimetry);
    EXPECT_NE(frame.storage, nullptr);
    ASSERT_NE(frame.planes[0].data, nullptr);
    ASSERT_NE(frame.planes[1].data, nullptr);
    EXPECT_GE(frame.planes[0].stride_bytes, frame.size.width);
    EXPECT_GE(frame.planes[1].stride_bytes, 2 * chroma_size(frame.size).width);
  }
}

TEST_P(CameraContract, PicturesCanBeReadToTheLastByte) {
  start();
  for (const VideoFrame& frame : read_frames(3)) {
    const ImageSize chroma = chroma_size(frame.size);
    const std::uint8_t* last_luma = frame.planes[0].data +
                                    (frame.size.height - 1) * frame.planes[0].stride_bytes +
                                    frame.size.width - 1;
    const std::uint8_t* last_chroma = frame.planes[1].data +
                                      (chroma.height - 1) * frame.planes[1].stride_bytes +
                                      2 * chroma.width - 1;
    std::set<int> values;
    for (int x = 0; x < frame.size.width; ++x) values.insert(frame.planes[0].data[x]);
    EXPECT_FALSE(values.empty());
    EXPECT_GE(*last_luma + *last_chroma, 0);  // a fault if there is nothing
  }
}

TEST_P(CameraContract, StampsAreOnClockMonotonicAndRise) {
  const SensorTime before = monotonic_now();
  start();
  SensorTime last = SensorTime::min();
  std::int64_t last_index = -1;
  for (int i = 0; i < kFrames; ++i) {
    const auto frames = read_frames(1);
    ASSERT_EQ(frames.size(), 1U);
    const FrameStamp& stamp = frames[0].stamp;
    EXPECT_GT(stamp.time, last);
    EXPECT_GT(stamp.index, last_index);
    EXPECT_GT(stamp.time, before - milliseconds(500));
    EXPECT_LE(stamp.time, monotonic_now() + GetParam().longest_ahead);
    last = stamp.time;
    last_index = stamp.index;
  }
}

TEST_P(CameraContract, EveryFrameComesOutOrIsCountedAsLost) {
  start();
  const auto first = read_frames(1);
  ASSERT_EQ(first.size(), 1U);
  const std::uint64_t lost_before = camera_->lost();
  const auto frames = read_frames(kFrames - 1);
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames - 1));
  const std::int64_t taken = frames.back().stamp.index - first[0].stamp.index;
  EXPECT_EQ(static_cast<std::uint64_t>(taken), frames.size() + camera_->lost() - lost_before);
}

TEST_P(CameraContract, FramesThatAreHeldKeepTheirPicturesAndStopNothing) {
  start();
  std::vector<VideoFrame> held;
  std::vector<std::vector<std::uint8_t>> rows;
  while (held.size() < static_cast<std::size_t>(kFrames)) {  // more than a device has buffers
    auto frames = read_frames(1);
    ASSERT_EQ(frames.size(), 1U);
    const ConstPlane luma = frames[0].planes[0];
    const std::uint8_t* row = luma.data + frames[0].size.height / 2 * luma.stride_bytes;
    rows.emplace_back(row, row + frames[0].size.width);
    held.push_back(std::move(frames[0]));
  }
  camera_.reset();
  for (std::size_t i = 0; i < held.size(); ++i) {
    const ConstPlane luma = held[i].planes[0];
    const std::uint8_t* row = luma.data + held[i].size.height / 2 * luma.stride_bytes;
    EXPECT_TRUE(std::equal(rows[i].begin(), rows[i].end(), row)) << i;
  }
}

TEST_P(CameraContract, NothingComesAfterStop) {
  start();
  ASSERT_EQ(read_frames(2).size(), 2U);
  camera_->stop();
  camera_->stop();  // once more is harmless
  const auto frame = camera_->read();
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_FALSE(frame->has_value());
}

TEST_P(CameraContract, StartsAgain) {
  camera_->stop();  // without start it is harmless
  std::vector<VideoFrame> held;
  for (int round = 0; round < 3; ++round) {
    start();
    auto frames = read_frames(3);
    ASSERT_EQ(frames.size(), 3U) << round;
    if (!held.empty()) {
      EXPECT_GT(frames[0].stamp.time, held.back().stamp.time);
    }
    held.insert(held.end(), frames.begin(), frames.end());  // beyond the next start
    camera_->stop();
  }
}

TEST_P(CameraContract, StopFromAnotherThreadEndsAReadThatWaits) {
  start();
  std::atomic<bool> has_ended = false;
  std::thread reader([&] {
    while (true) {
      const auto frame = camera_->read();
      EXPECT_TRUE(frame) << frame.error().message;
      if (!frame || !*frame) break;
    }
    has_ended = true;
  });
  std::this_thread::sleep_for(milliseconds(150));
  camera_->stop();
  for (int i = 0; i < 50 && !has_ended; ++i) std::this_thread::sleep_for(milliseconds(100));
  EXPECT_TRUE(has_ended) << "read still waits 5 s after stop";
  reader.join();
}

CameraOr paced_replay(const std::string& /*address*/, const std::filesystem::path& folder) {
  Session session;
  session.video = folder / "video.mkv";
  test::run_pipeline(fmt::format(
      "videotestsrc num-buffers=60 ! video/x-raw,width=96,height=64,framerate=60/1 ! x264enc "
      "bframes=0 ! matroskamux ! filesink location={}",
      session.video.string()));
  for (int i = 0; i < 60; ++i) {
    session.frames.push_back({i, SensorTime(milliseconds(1000 + 16 * i)), {}});
  }
  session.camera.emplace().fps = 60;
  return std::make_unique<PacedCamera>(session, std::make_shared<ReplayTimeline>(session),
                                       Repeat::forever);
}

#ifdef GIMBALD_DRIVER_V4L2
/// At the real pace, with a frame in ten lost.
CameraOr v4l2_over_a_fake(std::uint32_t fourcc) {
  const auto camera = std::make_shared<test::FakeCamera>();
  camera->pace = test::FakePace::real;
  camera->formats = {{fourcc, {{96, 64}}, {100}}};
  camera->script = [](std::uint32_t n, test::FakePicture& picture) {
    picture.sequence = n + n / 10;
  };
  const auto system = std::make_shared<test::FakeV4l2System>();
  system->cameras["/dev/video0"] = camera;
  V4l2CameraSettings settings;
  settings.device = "/dev/video0";
  return std::make_unique<V4l2Source>(settings, system);
}

CameraOr v4l2(const std::string& address, const std::filesystem::path& /*folder*/) {
  V4l2CameraSettings settings;
  settings.device = address;
  return open_v4l2_camera(settings);
}
#endif

#ifdef GIMBALD_DRIVER_LIBCAMERA
CameraOr libcamera_camera(const std::string& address, const std::filesystem::path& /*folder*/) {
  LibcameraSettings settings;
  settings.camera = address;
  if (const char* format = std::getenv("GIMBALD_TEST_LIBCAMERA_FORMAT")) {
    settings.pixel_format = format;
  }
  return open_libcamera_camera(settings);
}
#endif

std::vector<LiveCamera> cameras() {
  std::vector<LiveCamera> all = {{"PacedReplay", nullptr, paced_replay}};
#ifdef GIMBALD_DRIVER_V4L2
  all.push_back({"V4l2InPlace", nullptr,
                 [](const auto&, const auto&) { return v4l2_over_a_fake(V4L2_PIX_FMT_NV12); }});
  all.push_back({"V4l2Converted", nullptr,
                 [](const auto&, const auto&) { return v4l2_over_a_fake(V4L2_PIX_FMT_YUYV); }});
  all.push_back({"V4l2", "GIMBALD_TEST_V4L2", v4l2, kPlannedAhead});
#endif
#ifdef GIMBALD_DRIVER_LIBCAMERA
  all.push_back({"Libcamera", "GIMBALD_TEST_LIBCAMERA", libcamera_camera});
#endif
  return all;
}

INSTANTIATE_TEST_SUITE_P(Drivers, CameraContract, ::testing::ValuesIn(cameras()),
                         [](const auto& camera) -> std::string { return camera.param.name; });

}  // namespace
}  // namespace gimbal

#include "drivers/v4l2/v4l2_source.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <vector>

#include "pipeline/pixels/nv12_frame.hpp"
#include "tests/support/fake_v4l2.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::FakeCamera;
using test::FakePicture;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr auto kPath = "/dev/video0";
constexpr ImageSize kSize = {64, 48};

class V4l2SourceTest : public ::testing::Test {
 protected:
  std::shared_ptr<FakeCamera> camera_ = std::make_shared<FakeCamera>();
  std::shared_ptr<test::FakeV4l2System> system_ = std::make_shared<test::FakeV4l2System>();
  V4l2CameraSettings settings_;

  V4l2SourceTest() { system_->cameras[kPath] = camera_; }

  [[nodiscard]] std::unique_ptr<V4l2Source> started() {
    auto source = std::make_unique<V4l2Source>(settings_, system_);
    const auto begun = source->start();
    EXPECT_TRUE(begun) << begun.error().message;
    return source;
  }

  [[nodiscard]] Error error_of_start() {
    const auto begun = V4l2Source(settings_, system_).start();
    return begun ? Error{Error::Kind::failed, "it started"} : begun.error();
  }

  static VideoFrame next(V4l2Source& source) {
    auto frame = source.read();
    EXPECT_TRUE(frame && *frame) << (frame ? "no frame" : frame.error().message);
    return frame && *frame ? **frame : VideoFrame{};
  }

  static std::vector<std::int64_t> indices(V4l2Source& source, int count) {
    std::vector<std::int64_t> found;
    for (int i = 0; i < count; ++i) found.push_back(next(source).stamp.index);
    return found;
  }
};

std::uint8_t pixel(const VideoFrame& frame, std::size_t plane, int x, int y) {
  return frame.planes[plane].data[y * frame.planes[plane].stride_bytes + x];
}

TEST_F(V4l2SourceTest, PassesNv12OnWhereItLies) {
  camera_->stride_alignment = 100;
  const auto source = started();
  EXPECT_EQ(source->format().size, kSize);
  EXPECT_EQ(source->format().fps, 30);
  EXPECT_EQ(source->format().color.colorimetry, "bt709");
  for (std::uint32_t n = 0; n < 4; ++n) {
    const VideoFrame frame = next(*source);
    EXPECT_EQ(frame.size, kSize);
    EXPECT_EQ(frame.planes[1].data - frame.planes[0].data, 100 * 48);
    EXPECT_EQ(pixel(frame, 0, 63, 47), FakeCamera::default_byte(n, 0, 47 * 100 + 63));
    EXPECT_EQ(pixel(frame, 1, 63, 23), FakeCamera::default_byte(n, 0, (48 + 23) * 100 + 63));
  }
}

TEST_F(V4l2SourceTest, ADmaBufHoldsTheVeryPicture) {
  const auto source = started();
  const VideoFrame frame = next(*source);
  ASSERT_TRUE(frame.dma_buf);
  const DmaBufPlane& chroma = (*frame.dma_buf)[1];
  EXPECT_EQ(chroma.offset_bytes, 64 * 48);
  void* mapped = ::mmap(nullptr, 64 * 72, PROT_READ, MAP_SHARED, chroma.fd, 0);
  ASSERT_NE(mapped, MAP_FAILED);
  EXPECT_EQ(static_cast<const std::uint8_t*>(mapped)[chroma.offset_bytes + 64 * 3 + 5],
            pixel(frame, 1, 5, 3));
  ::munmap(mapped, 64 * 72);
}

TEST_F(V4l2SourceTest, ADmaBufIsClosedWithTheLastFrame) {
  auto source = started();
  std::optional<VideoFrame> frame = next(*source);
  const int fd = (*frame->dma_buf)[0].fd;
  source.reset();
  EXPECT_NE(::fcntl(fd, F_GETFD), -1);
  EXPECT_EQ(pixel(*frame, 0, 9, 9), FakeCamera::default_byte(0, 0, 9 * 64 + 9));
  frame.reset();
  EXPECT_EQ(::fcntl(fd, F_GETFD), -1);
}

TEST_F(V4l2SourceTest, ADriverThatExportsNothingStillGivesFrames) {
  camera_->exports_dma_buf = false;
  const auto source = started();
  EXPECT_FALSE(next(*source).dma_buf);
}

TEST_F(V4l2SourceTest, WhatTheProcessorPutsTogetherIsNotForDevices) {
  camera_->bus = "usb-xhci-hcd.0-1";
  const auto source = started();
  EXPECT_FALSE(next(*source).dma_buf);
}

TEST_F(V4l2SourceTest, ABufferGoesBackWithTheLastCopyOfItsFrame) {
  settings_.buffers = 4;
  const auto source = started();
  std::optional<VideoFrame> frame = next(*source);
  std::optional<VideoFrame> copy = frame;
  EXPECT_EQ(camera_->queued(), 3U);
  frame.reset();
  EXPECT_EQ(camera_->queued(), 3U);
  copy.reset();
  EXPECT_EQ(camera_->queued(), 4U);
}

TEST_F(V4l2SourceTest, APipelineThatHoldsManyDoesNotStarveTheCamera) {
  settings_.buffers = 4;
  const auto source = started();
  std::vector<VideoFrame> held;
  for (int i = 0; i < 20; ++i) {
    held.push_back(next(*source));
    EXPECT_GE(camera_->queued(), 2U);
  }
  for (std::uint32_t n = 0; n < held.size(); ++n) {
    EXPECT_EQ(pixel(held[n], 0, 5, 40), FakeCamera::default_byte(n, 0, 40 * 64 + 5)) << n;
    EXPECT_EQ(pixel(held[n], 1, 5, 20), FakeCamera::default_byte(n, 0, 68 * 64 + 5)) << n;
    EXPECT_EQ(held[n].dma_buf.has_value(), n < 2) << n;
  }
  EXPECT_EQ(source->lost(), 0U);
}

TEST_F(V4l2SourceTest, TwoMemoriesOfTheMultiPlanarInterfaceAreOnePicture) {
  camera_->capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  camera_->formats = {{V4L2_PIX_FMT_NV12M, {kSize}, {30}}};
  const auto source = started();
  const VideoFrame frame = next(*source);
  EXPECT_EQ(pixel(frame, 0, 7, 47), FakeCamera::default_byte(0, 0, 47 * 64 + 7));
  EXPECT_EQ(pixel(frame, 1, 7, 23), FakeCamera::default_byte(0, 1, 23 * 64 + 7));
  ASSERT_TRUE(frame.dma_buf);
  EXPECT_NE((*frame.dma_buf)[0].fd, (*frame.dma_buf)[1].fd);
  EXPECT_EQ((*frame.dma_buf)[1].offset_bytes, 0);
}

TEST_F(V4l2SourceTest, OneMemoryOfTheMultiPlanarInterfaceIsReadToo) {
  camera_->capabilities = V4L2_CAP_VIDEO_CAPTURE_MPLANE | V4L2_CAP_STREAMING;
  const auto source = started();
  EXPECT_EQ(pixel(next(*source), 1, 7, 23), FakeCamera::default_byte(0, 0, 71 * 64 + 7));
}

TEST_F(V4l2SourceTest, OtherLayoutsAreConverted) {
  struct Layout {
    std::uint32_t fourcc;
    std::size_t luma, u, v;  ///< where those of pixel (2, 0) lie
  };
  for (const Layout& layout :
       {Layout{V4L2_PIX_FMT_YUV420, 2, 64 * 48 + 1, 64 * 48 + 32 * 24 + 1},
        Layout{V4L2_PIX_FMT_YVU420, 2, 64 * 48 + 32 * 24 + 1, 64 * 48 + 1},
        Layout{V4L2_PIX_FMT_YUYV, 4, 5, 7}, Layout{V4L2_PIX_FMT_UYVY, 5, 4, 6}}) {
    camera_ = std::make_shared<FakeCamera>();
    camera_->formats = {{layout.fourcc, {kSize}, {30}}};
    const bool is_packed = layout.fourcc == V4L2_PIX_FMT_YUYV || layout.fourcc == V4L2_PIX_FMT_UYVY;
    // Rows alike, so that what is averaged of two stays what it is.
    camera_->content = [is_packed](std::uint32_t, std::size_t) {
      std::vector<std::uint8_t> bytes;
      for (std::size_t at = 0; at < std::size_t{128} * 48; ++at) {
        bytes.push_back(static_cast<std::uint8_t>(is_packed ? at % 128 : at * 31 + at / 251));
      }
      return bytes;
    };
    const auto bytes = camera_->content(0, 0);
    system_->cameras[kPath] = camera_;
    const auto source = started();
    const VideoFrame frame = next(*source);
    EXPECT_EQ(pixel(frame, 0, 2, 0), bytes[layout.luma]);
    EXPECT_EQ(pixel(frame, 1, 2, 0), bytes[layout.u]);
    EXPECT_EQ(pixel(frame, 1, 3, 0), bytes[layout.v]);
    EXPECT_FALSE(frame.dma_buf);
    EXPECT_EQ(camera_->queued(), 8U) << "a buffer whose picture is copied goes back at once";
  }
}

TEST_F(V4l2SourceTest, OtherLayoutsStayWhereTheyLieIfTheyAreAskedFor) {
  struct Layout {
    std::uint32_t fourcc;
    NativeFormat format;
    std::ptrdiff_t stride_bytes;
  };
  for (const Layout& layout : {Layout{V4L2_PIX_FMT_YUV420, NativeFormat::i420, 64},
                               Layout{V4L2_PIX_FMT_YVU420, NativeFormat::i420, 64},
                               Layout{V4L2_PIX_FMT_YUYV, NativeFormat::yuyv, 128},
                               Layout{V4L2_PIX_FMT_UYVY, NativeFormat::uyvy, 128}}) {
    camera_ = std::make_shared<FakeCamera>();
    camera_->formats = {{layout.fourcc, {kSize}, {30}}};
    system_->cameras[kPath] = camera_;
    const VideoFrame converted = next(*started());
    EXPECT_FALSE(converted.native);
    const auto source = started();
    source->ask_for(PictureForm::native);
    const VideoFrame frame = next(*source);
    ASSERT_TRUE(frame.native);
    EXPECT_EQ(frame.planes[0].data, nullptr);
    EXPECT_FALSE(frame.dma_buf);
    EXPECT_EQ(frame.native->format, layout.format);
    EXPECT_EQ(frame.native->planes[0].stride_bytes, layout.stride_bytes);
    EXPECT_EQ(camera_->queued(), 7U) << "its buffer is the frame's";
    ASSERT_TRUE(frame.native->dma_buf);
    EXPECT_GE((*frame.native->dma_buf)[0].fd, 0);
    const VideoFrame shown = as_nv12(frame);
    for (const auto& [x, y] : {std::pair{0, 0}, {5, 1}, {62, 23}, {63, 22}}) {
      EXPECT_EQ(pixel(shown, 0, x, y), pixel(converted, 0, x, y)) << x << "," << y;
      EXPECT_EQ(pixel(shown, 1, x, y), pixel(converted, 1, x, y)) << x << "," << y;
    }
  }
}

TEST_F(V4l2SourceTest, NativePicturesDoNotStarveTheCamera) {
  camera_->formats = {{V4L2_PIX_FMT_YUYV, {kSize}, {30}}};
  settings_.buffers = 4;
  const auto source = started();
  source->ask_for(PictureForm::native);
  std::vector<VideoFrame> held;
  for (int i = 0; i < 10; ++i) {
    held.push_back(next(*source));
    EXPECT_GE(camera_->queued(), 2U);
    EXPECT_EQ(held.back().native.has_value(), i < 2) << i;
  }
  for (std::uint32_t n = 0; n < held.size(); ++n) {
    EXPECT_EQ(pixel(as_nv12(held[n]), 0, 5, 40), FakeCamera::default_byte(n, 0, 40 * 128 + 10))
        << n;
  }
}

TEST_F(V4l2SourceTest, AJpegThatIsDamagedIsALoss) {
  camera_->formats = {{V4L2_PIX_FMT_MJPEG, {kSize}, {30}}};
  camera_->content = [](std::uint32_t, std::size_t) {
    return std::vector<std::uint8_t>(100, 0x55);
  };
  camera_->script = [](std::uint32_t n, FakePicture& picture) { picture.never_comes = n > 3; };
  const auto source = started();
  const auto frame = source->read();
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, HasSubstr("no picture for"));  // after four
  EXPECT_EQ(source->lost(), 4U);
  EXPECT_EQ(camera_->queued(), 8U);
}

TEST_F(V4l2SourceTest, StampsAndIndicesAreTheDevices) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    picture.stamp = std::chrono::hours(5) + milliseconds(30) * (n + 1);
    picture.sequence = n + 100;
  };
  const auto source = started();
  for (int n = 0; n < 3; ++n) {
    const VideoFrame frame = next(*source);
    EXPECT_EQ(frame.stamp.time, SensorTime(std::chrono::hours(5) + milliseconds(30) * (n + 1)));
    EXPECT_EQ(frame.stamp.index, n);
    EXPECT_FALSE(frame.stamp.exposure);
  }
}

TEST_F(V4l2SourceTest, GapsInTheSequenceAreLosses) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    picture.sequence = n < 2 ? n : n + 3;
  };
  const auto source = started();
  EXPECT_THAT(indices(*source, 4), ElementsAre(0, 1, 5, 6));
  EXPECT_EQ(source->lost(), 3U);
}

TEST_F(V4l2SourceTest, BuffersMarkedAsDamagedAreLosses) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    if (n == 0 || n == 3) picture.flags |= V4L2_BUF_FLAG_ERROR;
  };
  const auto source = started();
  EXPECT_THAT(indices(*source, 3), ElementsAre(1, 2, 4));
  EXPECT_EQ(source->lost(), 2U);
}

TEST_F(V4l2SourceTest, APictureThatIsCutOffIsALoss) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    if (n == 1) picture.bytes_used = 64 * 72 - 1;
  };
  const auto source = started();
  EXPECT_THAT(indices(*source, 2), ElementsAre(0, 2));
  EXPECT_EQ(source->lost(), 1U);
}

TEST_F(V4l2SourceTest, AStampThatDoesNotRiseIsALoss) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    if (n == 2) picture.stamp -= milliseconds(40);
  };
  const auto source = started();
  EXPECT_THAT(indices(*source, 3), ElementsAre(0, 1, 3));
  EXPECT_EQ(source->lost(), 1U);
}

TEST_F(V4l2SourceTest, AClockThatJumpsBackForLongIsAnError) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    if (n >= 2) picture.stamp -= seconds(60);
  };
  const auto source = started();
  EXPECT_THAT(indices(*source, 2), ElementsAre(0, 1));
  const auto frame = source->read();
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, HasSubstr("stamps that do not rise"));
  EXPECT_EQ(source->lost(), 30U);
}

TEST_F(V4l2SourceTest, AStampByAnotherClockIsConverted) {
  camera_->clocks[KernelClock::boottime] = std::chrono::hours(3);
  camera_->script = [](std::uint32_t, FakePicture& picture) {
    picture.stamp += std::chrono::hours(3);
  };
  const auto source = started();
  ASSERT_EQ(source->format().warnings.size(), 1U);
  EXPECT_THAT(source->format().warnings[0], HasSubstr("CLOCK_BOOTTIME"));
  // On the simulated clock the first picture comes a period after five hours.
  EXPECT_NEAR(seconds_since_epoch(next(*source).stamp.time), 5 * 3600 + 1 / 30.0, 2e-6);
}

TEST_F(V4l2SourceTest, AStampByNoClockIsRefused) {
  camera_->script = [](std::uint32_t, FakePicture& picture) { picture.stamp -= seconds(7); };
  EXPECT_THAT(error_of_start().message, HasSubstr("/dev/video0: its stamps are by none of"));
  EXPECT_THAT(error_of_start().message, HasSubstr("7.000 s behind"));
  EXPECT_FALSE(camera_->is_streaming());
}

TEST_F(V4l2SourceTest, StampingOnArrivalNeedsNoClockOfTheDevice) {
  settings_.stamp_source = StampSource::arrival;
  camera_->script = [](std::uint32_t, FakePicture& picture) { picture.stamp = {}; };
  const auto source = started();
  EXPECT_EQ(source->format().timestamp, TimestampReference::readout_end);
  const SensorTime first = next(*source).stamp.time;
  EXPECT_NEAR(to_seconds(next(*source).stamp.time - first), 1 / 30.0, 1e-6);
}

TEST_F(V4l2SourceTest, TheInstantIsThatOfTheFlagsUnlessTheSettingsKnowBetter) {
  EXPECT_EQ(started()->format().timestamp, TimestampReference::readout_end);
  camera_->script = [](std::uint32_t, FakePicture& picture) {
    picture.flags |= V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  };
  EXPECT_EQ(started()->format().timestamp, TimestampReference::exposure_start);
  settings_.timestamp = TimestampReference::readout_start;
  EXPECT_EQ(started()->format().timestamp, TimestampReference::readout_start);
}

TEST_F(V4l2SourceTest, ControlsReadoutAndExposureAreTheCameras) {
  camera_->controls = {
      {V4L2_CID_EXPOSURE_ABSOLUTE, "Exposure", V4L2_CTRL_TYPE_INTEGER, 1, 500, 1},
      {V4L2_CID_HBLANK, "Horizontal Blanking", V4L2_CTRL_TYPE_INTEGER, 0, 9999, 36},
      {V4L2_CID_PIXEL_RATE, "Pixel Rate", V4L2_CTRL_TYPE_INTEGER64, 0, 99'999'999, 480'000}};
  settings_.controls = {{"exposure", 80}};
  const auto source = started();
  EXPECT_EQ(source->format().readout, milliseconds(10));
  EXPECT_EQ(next(*source).stamp.exposure, milliseconds(8));
  source->stop();
  settings_.controls = {{"exposures", 80}};
  EXPECT_THAT(error_of_start().message, HasSubstr("/dev/video0: has no control exposures"));
}

TEST_F(V4l2SourceTest, SilenceIsAnError) {
  settings_.silence_limit = seconds(3);
  camera_->script = [](std::uint32_t n, FakePicture& picture) { picture.never_comes = n > 1; };
  const auto source = started();
  EXPECT_THAT(indices(*source, 2), ElementsAre(0, 1));
  const auto frame = source->read();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().message, "/dev/video0: no picture for 3.0 s");
}

TEST_F(V4l2SourceTest, ACameraThatNeverBeginsIsAnError) {
  camera_->script = [](std::uint32_t, FakePicture& picture) { picture.never_comes = true; };
  EXPECT_THAT(error_of_start().message, HasSubstr("no picture for"));
}

TEST_F(V4l2SourceTest, AnUnpluggedCameraIsAnErrorAndComesBackUnderAnotherNumber) {
  settings_.device = "Fake Camera";
  const auto source = started();
  const VideoFrame held = next(*source);
  camera_->unplug();
  auto frame = source->read();
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().message, "/dev/video0: the camera has been unplugged");
  EXPECT_FALSE(source->start());
  EXPECT_FALSE(source->read().value_or(std::nullopt)) << "it did not start";

  camera_->plug_in();
  system_->cameras = {{"/dev/video5", camera_}};
  ASSERT_TRUE(source->start());
  EXPECT_EQ(next(*source).stamp.index, 0);
  EXPECT_EQ(pixel(held, 0, 3, 3), FakeCamera::default_byte(0, 0, 3 * 64 + 3));
}

TEST_F(V4l2SourceTest, AFailingDeviceSaysHow) {
  camera_->script = [](std::uint32_t n, FakePicture& picture) {
    if (n == 1) picture.dequeue_error = EIO;
  };
  const auto source = started();
  static_cast<void>(next(*source));
  const auto frame = source->read();
  ASSERT_FALSE(frame);
  EXPECT_THAT(frame.error().message, HasSubstr("Input/output error"));
}

TEST_F(V4l2SourceTest, StopLeavesTheCameraToOthersThoughFramesAreHeld) {
  const auto source = started();
  const VideoFrame held = next(*source);
  source->stop();
  EXPECT_FALSE(camera_->is_streaming());
  const auto other = started();
  EXPECT_EQ(next(*other).stamp.index, 0);
  EXPECT_EQ(pixel(held, 0, 3, 3), FakeCamera::default_byte(0, 0, 3 * 64 + 3));
}

TEST_F(V4l2SourceTest, ABusyCameraNamesItsUser) {
  const auto other = started();
  system_->users = "cheese (pid 812)";
  EXPECT_EQ(error_of_start().message, "/dev/video0: busy: in use by cheese (pid 812)");
}

TEST(OpenV4l2Camera, RefusesSettingsThatMakeNoSense) {
  const auto message = [](const auto& change) {
    V4l2CameraSettings settings;
    change(settings);
    const auto camera = open_v4l2_camera(settings);
    return camera ? std::string() : camera.error().message;
  };
  EXPECT_EQ(message([](auto&) {}), "");
  EXPECT_THAT(message([](auto& s) { s.buffers = 1; }), HasSubstr("from 2 to 32"));
  EXPECT_THAT(message([](auto& s) { s.buffers = 33; }), HasSubstr("from 2 to 32"));
  EXPECT_THAT(message([](auto& s) { s.fps = 0; }), HasSubstr("fps is 0"));
  EXPECT_THAT(message([](auto& s) { s.fps = std::nan(""); }), HasSubstr("fps is nan"));
  EXPECT_THAT(message([](auto& s) { s.size = ImageSize{0, 480}; }), HasSubstr("size 0x480"));
  EXPECT_THAT(message([](auto& s) { s.silence_limit = {}; }), HasSubstr("silence"));
}

}  // namespace
}  // namespace gimbal

#include "drivers/v4l2/picture_format.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_v4l2.hpp"

namespace gimbal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr ImageSize kVga = {640, 480};
constexpr ImageSize kHd = {1280, 720};

/// As a webcam over USB 2 offers it: what is large is fast only when compressed.
std::vector<OfferedFormat> webcam() {
  return {{V4L2_PIX_FMT_MJPEG, {{kVga, {30}}, {kHd, {60, 30}}}, {}},
          {V4L2_PIX_FMT_YUYV, {{kVga, {30, 15}}, {kHd, {10}}}, {}}};
}

std::string chosen(const std::vector<OfferedFormat>& offered, const FormatWish& wish) {
  const auto format = choose_format(offered, wish);
  return format ? name_of_fourcc(format->fourcc) : format.error().message;
}

TEST(ChooseFormat, TakesTheLeastWorkThatReachesTheRate) {
  EXPECT_EQ(chosen(webcam(), {kVga, 30, "auto"}), "YUYV");
  EXPECT_EQ(chosen(webcam(), {kHd, 30, "auto"}), "MJPG");
  EXPECT_EQ(chosen(webcam(), {kHd, 10, "auto"}), "YUYV");
  EXPECT_EQ(chosen(webcam(), {kVga, 29.97, "auto"}), "YUYV");
}

TEST(ChooseFormat, WithoutARateTheUsualOneCounts) {
  EXPECT_EQ(chosen(webcam(), {kHd, {}, "auto"}), "MJPG");
  EXPECT_EQ(chosen(webcam(), {kVga, {}, "auto"}), "YUYV");
}

TEST(ChooseFormat, Nv12GoesFirst) {
  auto offered = webcam();
  offered.push_back({V4L2_PIX_FMT_NV12, {{kVga, {30}}}, {}});
  EXPECT_EQ(chosen(offered, {kVga, 30, "auto"}), "NV12");
  EXPECT_EQ(chosen(offered, {kHd, 30, "auto"}), "MJPG");
}

TEST(ChooseFormat, ANamedFormatIsTaken) {
  EXPECT_EQ(chosen(webcam(), {kVga, 30, "MJPG"}), "MJPG");
}

TEST(ChooseFormat, ADeviceThatListsNothingIsAsked) {
  EXPECT_EQ(chosen({{V4L2_PIX_FMT_UYVY, {}, {}}}, {kHd, 50, "auto"}), "UYVY");
}

TEST(ChooseFormat, WhatThereIsNotIsAnsweredByWhatThereIs) {
  EXPECT_EQ(chosen(webcam(), {kVga, 30, "NV12"}),
            "does not offer pixel format NV12; it offers MJPG: 640x480 (30 fps), 1280x720 (60, 30 "
            "fps); YUYV: 640x480 (30, 15 fps), 1280x720 (10 fps)");
  EXPECT_THAT(chosen(webcam(), {ImageSize{641, 480}, 30, "auto"}),
              HasSubstr("does not offer 641x480; it offers MJPG"));
  EXPECT_THAT(chosen(webcam(), {kHd, 25, "auto"}),
              HasSubstr("does not offer 25 frames a second; it offers"));
}

TEST(ChooseFormat, ARawSensorIsSentToTheOtherDriver) {
  EXPECT_THAT(chosen({{V4L2_PIX_FMT_SRGGB10, {}, {}}}, {}), HasSubstr("(RG10)"));
  EXPECT_THAT(chosen({{V4L2_PIX_FMT_SRGGB10, {}, {}}}, {}), HasSubstr("libcamera"));
}

/// A device that lists a range of sizes, as ISPs do.
class RangedDevice final : public V4l2Device {
 public:
  int request(unsigned long code, void* argument) override {
    if (code == VIDIOC_ENUM_FMT) {
      auto& listed = *static_cast<v4l2_fmtdesc*>(argument);
      listed.pixelformat = V4L2_PIX_FMT_NV12;
      return listed.index == 0 ? 0 : EINVAL;
    }
    if (code != VIDIOC_ENUM_FRAMESIZES) return ENOTTY;
    auto& listed = *static_cast<v4l2_frmsizeenum*>(argument);
    listed.type = V4L2_FRMSIZE_TYPE_STEPWISE;
    listed.stepwise = {64, 1920, 16, 64, 1080, 2};
    return listed.index == 0 ? 0 : EINVAL;
  }
  std::uint8_t* map(std::size_t, std::int64_t) override { return nullptr; }
  void unmap(std::uint8_t*, std::size_t) override {}
  Wakeup wait(SensorDuration) override { return Wakeup::error; }
  void cancel() override {}
  [[nodiscard]] std::optional<SensorDuration> read_clock(KernelClock) const override { return {}; }
};

TEST(OfferedFormats, OfARangeTheSizeHasToLieOnItsSteps) {
  RangedDevice device;
  const auto offers = [&](ImageSize size) {
    const auto offered = offered_formats(device, V4L2_BUF_TYPE_VIDEO_CAPTURE, size);
    return chosen(offered, {size, {}, "auto"});
  };
  EXPECT_EQ(offers({1920, 1080}), "NV12");
  EXPECT_EQ(offers({80, 66}), "NV12");
  EXPECT_EQ(offers({72, 66}), "does not offer 72x66; it offers NV12: 64x64 to 1920x1080");
  EXPECT_THAT(offers({1936, 1080}), HasSubstr("does not offer"));
}

PictureFormat format_of(PixelLayout layout, ImageSize size, std::vector<PictureMemory> memories) {
  PictureFormat format;
  format.layout = layout;
  format.size = size;
  format.memories = std::move(memories);
  return format;
}

TEST(LeastBytes, AreThoseOfTheKernelsPixelFormats) {
  // pixfmt-yuv-planar.rst, pixfmt-packed-yuv.rst; the last row needs no padding behind it.
  EXPECT_THAT(least_bytes(format_of(PixelLayout::nv12, {4, 4}, {{4, 24}})), ElementsAre(24));
  EXPECT_THAT(least_bytes(format_of(PixelLayout::i420, {4, 4}, {{4, 24}})), ElementsAre(24));
  EXPECT_THAT(least_bytes(format_of(PixelLayout::yuyv, {4, 4}, {{8, 32}})), ElementsAre(32));
  EXPECT_THAT(least_bytes(format_of(PixelLayout::grey, {4, 4}, {{16, 64}})), ElementsAre(52));
  EXPECT_THAT(least_bytes(format_of(PixelLayout::nv12_two_memories, {4, 4}, {{4, 16}, {4, 8}})),
              ElementsAre(16, 8));
  EXPECT_TRUE(least_bytes(format_of(PixelLayout::mjpeg, {4, 4}, {{0, 100}})).empty());
}

TEST(LeastBytes, ARowThatReachesIntoTheNextFitsNoBuffer) {
  EXPECT_THAT(least_bytes(format_of(PixelLayout::yuyv, {5, 4}, {{10, 40}})), ElementsAre(SIZE_MAX));
}

TEST(PlacesOf, YvuHasItsChromaPlanesSwapped) {
  const auto i420 = places_of(format_of(PixelLayout::i420, {6, 5}, {{8, 100}}));
  const auto yv12 = places_of(format_of(PixelLayout::yv12, {6, 5}, {{8, 100}}));
  ASSERT_EQ(i420.size(), 3U);
  EXPECT_EQ(i420[1].offset_bytes, 40);
  EXPECT_EQ(i420[2].offset_bytes, 40 + 4 * 3);
  EXPECT_EQ(i420[1].stride_bytes, 4);
  EXPECT_EQ(yv12[1].offset_bytes, i420[2].offset_bytes);
  EXPECT_EQ(yv12[2].offset_bytes, i420[1].offset_bytes);
}

Result<PictureFormat> set(const std::shared_ptr<test::FakeCamera>& camera, const FormatWish& wish) {
  const auto device = camera->open();
  return set_format(*device, V4L2_BUF_TYPE_VIDEO_CAPTURE, {V4L2_PIX_FMT_NV12, PixelLayout::nv12},
                    wish, "cheese (pid 12)");
}

TEST(SetFormat, ReadsBackWhatItIs) {
  const auto camera = std::make_shared<test::FakeCamera>();
  camera->formats = {{V4L2_PIX_FMT_NV12, {{66, 48}, {64, 48}}, {30, 60}}};
  camera->stride_alignment = 64;
  const auto format = set(camera, {ImageSize{66, 48}, 60, "auto"});
  ASSERT_TRUE(format) << format.error().message;
  EXPECT_EQ(format->size, (ImageSize{66, 48}));
  EXPECT_EQ(format->fps, 60);
  EXPECT_EQ(format->color.colorimetry, "bt709");
  ASSERT_EQ(format->memories.size(), 1U);
  EXPECT_EQ(format->memories[0].stride_bytes, 128);
}

TEST(SetFormat, SomethingElseThanAskedForIsAnError) {
  const auto camera = std::make_shared<test::FakeCamera>();
  const auto size = set(camera, {ImageSize{128, 96}, {}, "auto"});
  ASSERT_FALSE(size);
  EXPECT_EQ(size.error().message, "gives NV12 64x48 instead of NV12 128x96");
  const auto rate = set(camera, {ImageSize{64, 48}, 50, "auto"});
  ASSERT_FALSE(rate);
  EXPECT_EQ(rate.error().message, "gives 30 frames a second instead of 50");
}

TEST(SetFormat, InterlacedPicturesAreRefused) {
  const auto camera = std::make_shared<test::FakeCamera>();
  camera->field = V4L2_FIELD_INTERLACED;
  const auto format = set(camera, {ImageSize{64, 48}, {}, "auto"});
  ASSERT_FALSE(format);
  EXPECT_THAT(format.error().message, HasSubstr("interlaced"));
}

TEST(SetFormat, ABusyDeviceNamesItsUser) {
  const auto camera = std::make_shared<test::FakeCamera>();
  const auto other = camera->open();
  v4l2_requestbuffers buffers{};
  buffers.count = 2;
  ASSERT_EQ(other->request(VIDIOC_REQBUFS, &buffers), 0);
  const auto format = set(camera, {ImageSize{64, 48}, {}, "auto"});
  ASSERT_FALSE(format);
  EXPECT_EQ(format.error().message, "busy: in use by cheese (pid 12)");
}

}  // namespace
}  // namespace gimbal

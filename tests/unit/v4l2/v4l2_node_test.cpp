#include "drivers/v4l2/v4l2_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_v4l2.hpp"

namespace gimbal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

std::shared_ptr<test::FakeCamera> camera(const std::string& name, const std::string& bus) {
  auto made = std::make_shared<test::FakeCamera>();
  made->name = name;
  made->bus = bus;
  return made;
}

/// A webcam with its metadata node, an ISP's output, and another webcam.
std::unique_ptr<test::FakeV4l2System> machine() {
  auto system = std::make_unique<test::FakeV4l2System>();
  system->cameras["/dev/video0"] = camera("Webcam", "usb-1");
  system->cameras["/dev/video0"]->capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING;
  system->cameras["/dev/video1"] = camera("Webcam", "usb-1");
  system->cameras["/dev/video2"] = camera("Isp", "platform:isp");
  system->cameras["/dev/video2"]->capabilities = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING;
  system->cameras["/dev/video3"] = camera("Other", "usb-2");
  return system;
}

std::string path_found(const test::FakeV4l2System& system, const std::string& wanted) {
  const auto node = find_node(system, wanted);
  return node ? node->path : node.error().message;
}

TEST(FindNode, ByPathNameOrBus) {
  const auto system = machine();
  EXPECT_EQ(path_found(*system, "/dev/video3"), "/dev/video3");
  EXPECT_EQ(path_found(*system, "Other"), "/dev/video3");
  EXPECT_EQ(path_found(*system, "usb-2"), "/dev/video3");
  EXPECT_EQ(path_found(*system, "Webcam"), "/dev/video1");  // not its metadata
}

TEST(FindNode, WithoutAWishTheFirstThatCanBeReadIsTaken) {
  const auto system = machine();
  system->cameras["/dev/video1"]->formats = {{V4L2_PIX_FMT_SRGGB10, {{64, 48}}, {30}}};
  EXPECT_EQ(path_found(*system, ""), "/dev/video3");
}

TEST(FindNode, SaysWhatIsInTheWay) {
  const auto system = machine();
  EXPECT_EQ(path_found(*system, "/dev/video0"), "/dev/video0: metadata node, no pictures");
  EXPECT_EQ(path_found(*system, "/dev/video2"), "/dev/video2: shows pictures, takes none");
  EXPECT_EQ(path_found(*system, "Webcan"),
            "no camera is called 'Webcan'; there is Webcam (/dev/video1), Other (/dev/video3)");
  EXPECT_THAT(path_found(test::FakeV4l2System(), ""), HasSubstr("there is no camera"));
  test::FakeV4l2System locked;
  locked.refused["/dev/video0"] = "no permission: add the user to group video";
  EXPECT_EQ(path_found(locked, ""),
            "no camera can be used: /dev/video0: no permission: add the user to group video");
}

TEST(ReportNodes, DescribesWhatIsThere) {
  const auto system = machine();
  system->refused["/dev/video4"] = "no permission: add the user to group video";
  const auto reports = report_nodes(*system);
  ASSERT_EQ(reports.size(), 5U);
  EXPECT_EQ(reports[0].obstacle, "metadata node, no pictures");
  EXPECT_EQ(reports[1].driver, "v4l2");
  EXPECT_EQ(reports[1].address, "/dev/video1");
  EXPECT_EQ(reports[1].name, "Webcam");
  EXPECT_EQ(reports[1].obstacle, "");
  EXPECT_THAT(reports[1].details, Contains("bus: usb-1"));
  EXPECT_THAT(reports[1].details, Contains("NV12: 64x48 (30 fps)"));
  EXPECT_THAT(reports[1].details,
              Contains("stamps: by CLOCK_MONOTONIC, at the end of the frame (as the driver says)"));
  EXPECT_EQ(reports[4].obstacle, "no permission: add the user to group video");
}

TEST(ReportNodes, LeavesTheCameraFree) {
  const auto system = machine();
  static_cast<void>(report_nodes(*system));
  const auto other = system->cameras.at("/dev/video1")->open();
  v4l2_requestbuffers buffers{};
  buffers.count = 2;
  EXPECT_EQ(other->request(VIDIOC_REQBUFS, &buffers), 0);
}

TEST(ReportNodes, NamesWhoHasTheCamera) {
  const auto system = machine();
  system->users = "cheese (pid 812)";
  const auto other = system->cameras.at("/dev/video1")->open();
  v4l2_requestbuffers buffers{};
  buffers.count = 2;
  ASSERT_EQ(other->request(VIDIOC_REQBUFS, &buffers), 0);
  EXPECT_EQ(report_nodes(*system)[1].obstacle, "busy: in use by cheese (pid 812)");
  EXPECT_EQ(report_nodes(*system)[3].obstacle, "");
}

TEST(ReportNodes, TellsTheReadoutThatTheSensorHas) {
  const auto system = machine();
  system->sensor = std::make_shared<test::FakeCamera>();
  system->sensor->controls = {
      {V4L2_CID_HBLANK, "Horizontal Blanking", V4L2_CTRL_TYPE_INTEGER, 0, 9999, 36},
      {V4L2_CID_PIXEL_RATE, "Pixel Rate", V4L2_CTRL_TYPE_INTEGER64, 0, 99'999'999, 480'000}};
  // 48 lines of 64 + 36 pixels, 480 of them in a millisecond.
  EXPECT_THAT(report_nodes(*system)[1].details, Contains("readout: 10.00 ms as it is set now"));
}

}  // namespace
}  // namespace gimbal

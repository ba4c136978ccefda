#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

#include "pipeline/sink/frame_sink.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;
using test::irregular_stamps;
using test::test_picture;

constexpr ImageSize kSize{160, 90};

Result<void> write_pictures(const std::string& out, const SinkFormat& format,
                            const std::vector<FrameStamp>& stamps) {
  auto sink = open_sink(out, format, std::nullopt);
  if (!sink) {
    return tl::unexpected(sink.error());
  }
  for (const FrameStamp& stamp : stamps) {
    if (auto written = (*sink)->write(test_picture(format.size, stamp, format.color)); !written) {
      return written;
    }
  }
  return (*sink)->finish();
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

test::Playback play_file(const std::filesystem::path& path) {
  return test::play(fmt::format(
      "filesrc location={} ! decodebin ! videoconvert ! video/x-raw,format=NV12 ! appsink name=out",
      path.string()));
}

struct Container {
  const char* extension;
  std::int64_t grain_ns;
};

class VideoFileTest : public ::testing::TestWithParam<Container> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(VideoFileTest, CaptureTimesBecomePresentationTimes) {
  const auto path = folder_.path() / (std::string("out") + GetParam().extension);
  const auto stamps = irregular_stamps(60);
  const auto written = write_pictures(path, {kSize, 30, {}}, stamps);
  ASSERT_TRUE(written) << written.error().message;

  const test::Playback playback = play_file(path);
  ASSERT_EQ(playback.buffers.size(), stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto expected = (stamps[i].time - stamps[0].time).count();
    EXPECT_LE(std::abs(playback.buffers[i].running_time_ns - expected), GetParam().grain_ns) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Containers, VideoFileTest,
                         ::testing::Values(Container{".mp4", 1'000'000'000 / 90'000 + 1},
                                           Container{".mkv", 100'000}),
                         [](const auto& container) { return container.param.extension + 1; });

TEST(Y4mTest, HoldsTheVeryPixels) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "out.y4m";
  constexpr ImageSize kOdd{33, 17};
  const auto stamps = irregular_stamps(3);
  const auto written =
      write_pictures(path, {kOdd, 30000.0 / 1001, {"bt709", ChromaSiting::center}}, stamps);
  ASSERT_TRUE(written) << written.error().message;

  std::string expected = "YUV4MPEG2 W33 H17 F30000:1001 Ip A1:1 C420jpeg XCOLORRANGE=LIMITED\n";
  for (const FrameStamp& stamp : stamps) {
    expected += "FRAME\n";
    for (int y = 0; y < 17; ++y) {
      for (int x = 0; x < 33; ++x) {
        expected += static_cast<char>(test::sample_of(stamp.index, 0, x, y));
      }
    }
    for (const int u_or_v : {0, 1}) {
      for (int y = 0; y < 9; ++y) {
        for (int x = 0; x < 17; ++x) {
          expected += static_cast<char>(test::sample_of(stamp.index, 1, 2 * x + u_or_v, y));
        }
      }
    }
  }
  EXPECT_EQ(bytes_of(path), expected);
}

TEST(PipelineTest, TakesAnyPipelineText) {
  const auto written =
      write_pictures("identity ! fakesink", {kSize, 30, {}}, irregular_stamps(10));
  EXPECT_TRUE(written) << written.error().message;
}

}  // namespace
}  // namespace gimbal

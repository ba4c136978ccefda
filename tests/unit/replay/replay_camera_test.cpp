#include "drivers/replay/replay_camera.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;
using test::irregular_stamps;

/// A lossless 64x48 video whose luma pixels are known, at 10 pictures a second, made without the code
/// under test: raw pictures are put into a file and encoded from there.
void make_lossless_video(const std::filesystem::path& path, int count, const std::string& encoder) {
  const std::filesystem::path raw = path.string() + ".raw";
  std::ofstream file(raw, std::ios::binary);
  for (int frame = 0; frame < count; ++frame) {
    for (const int plane : {0, 1, 2}) {
      const auto bytes = test::packed_plane(frame, plane, plane == 0 ? 64 : 32, plane == 0 ? 48 : 24);
      file.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    }
  }
  file.close();
  test::run_pipeline(fmt::format("filesrc location={} blocksize={} ! rawvideoparse width=64 height=48 "
                                 "format=i420 framerate=10/1 colorimetry=bt709 ! {} ! filesink location={}",
                                 raw.string(), 64 * 48 * 3 / 2, encoder, path.string()));
}

void expect_picture(const VideoFrame& frame, std::int64_t index) {
  ASSERT_EQ(frame.size, (ImageSize{64, 48}));
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      ASSERT_EQ(frame.planes[0].data[y * frame.planes[0].stride_bytes + x],
                test::sample_of(index, 0, x, y))
          << "luma " << x << ", " << y << " of " << index;
    }
  }
  for (int y = 0; y < 24; ++y) {
    for (int x = 0; x < 64; ++x) {
      ASSERT_EQ(frame.planes[1].data[y * frame.planes[1].stride_bytes + x],
                test::sample_of(index, 1 + x % 2, x / 2, y))
          << "chroma " << x << ", " << y << " of " << index;
    }
  }
}

std::vector<VideoFrame> read_all(ReplayCamera& camera) {
  std::vector<VideoFrame> frames;
  for (;;) {
    auto frame = camera.read();
    if (!frame) {
      ADD_FAILURE() << frame.error().message;
      return frames;
    }
    if (!*frame) {
      return frames;
    }
    frames.push_back(**std::move(frame));
  }
}

class LosslessVideoTest : public ::testing::TestWithParam<const char*> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(LosslessVideoTest, DeliversTheVeryPixelsWithTheListsStamps) {
  const auto path = folder_.path() / "video.mkv";
  make_lossless_video(path, 12, std::string(GetParam()) + " ! matroskamux");
  const auto stamps = irregular_stamps(12);
  ReplayCamera camera(path, stamps, 0);
  const auto started = camera.start();
  ASSERT_TRUE(started) << started.error().message;
  EXPECT_EQ(camera.format().size, (ImageSize{64, 48}));
  EXPECT_DOUBLE_EQ(camera.format().fps, 10);
  EXPECT_EQ(camera.format().color.colorimetry, "bt709");

  const auto frames = read_all(camera);
  ASSERT_EQ(frames.size(), stamps.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].stamp.index, stamps[i].index);
    EXPECT_EQ(frames[i].stamp.time, stamps[i].time);
    expect_picture(frames[i], static_cast<std::int64_t>(i));
  }
  EXPECT_TRUE(camera.warnings().empty());
}

INSTANTIATE_TEST_SUITE_P(Encoders, LosslessVideoTest,
                         ::testing::Values("identity", "avenc_ffv1", "x264enc pass=quant quantizer=0"));

TEST(ReplayCamera, LeavesOutPicturesThatHaveNoStamp) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.mkv";
  make_lossless_video(path, 8, "identity ! matroskamux");
  auto stamps = irregular_stamps(8);
  stamps.erase(stamps.begin() + 3, stamps.begin() + 5);
  stamps.erase(stamps.begin());
  ReplayCamera camera(path, stamps, 0);
  ASSERT_TRUE(camera.start());

  const auto frames = read_all(camera);
  ASSERT_EQ(frames.size(), stamps.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].stamp.time, stamps[i].time);
    expect_picture(frames[i], stamps[i].index);
  }
  EXPECT_EQ(camera.frames_without_stamp(), 3);
  EXPECT_EQ(camera.stamps_without_frame(), 0);
}

}  // namespace
}  // namespace gimbal

#include "drivers/replay/video_probe.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

struct Recording {
  const char* test_name;
  const char* name;
  const char* encoder_and_muxer;
};

class ProbeTest : public ::testing::TestWithParam<Recording> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(ProbeTest, CountsAndTimesPictures) {
  const auto path = folder_.path() / GetParam().name;
  test::run_pipeline(
      fmt::format("videotestsrc num-buffers=40 ! video/x-raw,width=96,height=64,framerate=20/1 ! "
                  "{} name=muxer ! "
                  "filesink location={} audiotestsrc num-buffers=40 samplesperbuffer=2400 ! "
                  "audio/x-raw,rate=48000 ! opusenc ! muxer.",
                  GetParam().encoder_and_muxer, path.string()));
  const auto info = probe_video(path);
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->size, (ImageSize{96, 64}));
  EXPECT_DOUBLE_EQ(info->fps, 20);
  EXPECT_EQ(info->frame_count, 40);
  EXPECT_TRUE(info->has_audio);
  EXPECT_EQ(info->damage, "");
  ASSERT_EQ(info->frame_times.size(), 40U);
  for (int i = 0; i < 40; ++i) {
    const auto time = info->frame_times[static_cast<std::size_t>(i)] - info->frame_times[0];
    EXPECT_LE(abs(time - i * std::chrono::milliseconds(50)), std::chrono::milliseconds(1)) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Containers, ProbeTest,
    ::testing::Values(Recording{"BFramesInMp4", "b_frames.mp4", "x264enc bframes=2 ! mp4mux"},
                      Recording{"BFramesInMatroska", "b_frames.mkv",
                                "x264enc bframes=2 ! matroskamux"},
                      Recording{"Vp8InWebm", "vp8.webm", "vp8enc deadline=1 ! webmmux"}),
    [](const auto& recording) -> std::string { return recording.param.test_name; });

TEST(ProbeErrorsTest, RefusesWhatIsNoVideo) {
  const test::TemporaryFolder folder;
  folder.write("text.mp4", "This is not a video.\n");
  folder.write("empty.mp4", "");
  test::run_pipeline(
      fmt::format("audiotestsrc num-buffers=20 ! opusenc ! matroskamux ! filesink location={}",
                  (folder.path() / "sound.mkv").string()));
  for (const char* name : {"text.mp4", "empty.mp4", "sound.mkv", "missing.mp4", "."}) {
    const auto info = probe_video(folder.path() / name);
    ASSERT_FALSE(info) << name;
    EXPECT_EQ(info.error().kind, Error::Kind::bad_input) << name;
    EXPECT_THAT(info.error().message, HasSubstr((folder.path() / name).string()));
    EXPECT_THAT(info.error().message, HasSubstr("video")) << name;
  }
}

}  // namespace
}  // namespace gimbal

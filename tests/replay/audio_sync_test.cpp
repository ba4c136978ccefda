// Sound and picture stay together when a session's first pictures are left out.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/gst_playback.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

namespace fs = std::filesystem;

constexpr int kLimit_s = 60;
constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kPictures = 50;
constexpr int kRate = 10;
constexpr int kLeftOut = 13;

/// Grey pictures, white ones at every full second.
void write_flashes(const fs::path& raw) {
  std::ofstream file(raw, std::ios::binary);
  for (int i = 0; i < kPictures; ++i) {
    const char luma = static_cast<char>(i % kRate == 0 ? 230 : 60);
    file << std::string(kWidth * kHeight, luma) << std::string(kWidth * kHeight / 2, '\x80');
  }
}

/// Seconds at which a picture is white after one that was not.
std::vector<double> flashes(const fs::path& video) {
  const auto playback =
      test::play(fmt::format("filesrc location={} ! decodebin ! videoconvert ! "
                             "video/x-raw,format=GRAY8 ! appsink name=out",
                             video.string()));
  std::vector<double> found;
  bool was_white = false;
  for (const auto& picture : playback.buffers) {
    const double sum = std::accumulate(picture.bytes.begin(), picture.bytes.end(), 0.0);
    const bool is_white = sum / static_cast<double>(picture.bytes.size()) > 150;
    if (is_white && !was_white) {
      found.push_back(1e-9 * static_cast<double>(picture.running_time_ns));
    }
    was_white = is_white;
  }
  return found;
}

/// How long after each flash the next sound sets in.
std::vector<double> sound_after_flash(const fs::path& video) {
  const std::vector<double> onsets = test::sound_onsets(video);
  std::vector<double> delays;
  for (const double flash : flashes(video)) {
    for (const double onset : onsets) {
      if (std::abs(onset - flash) < 0.4) delays.push_back(onset - flash);
    }
  }
  return delays;
}

struct Recording {
  const char* name;
  const char* file;
  const char* muxer;
  const char* video_encoder;
  const char* audio_encoder;
};

void PrintTo(const Recording& recording, std::ostream* out) {
  *out << recording.name;
}

class AudioSync : public ::testing::TestWithParam<Recording> {};

TEST_P(AudioSync, IsKeptWhenTheFirstPicturesAreLeftOut) {
  const test::TemporaryFolder folder;
  const fs::path session = folder.path() / "session";
  std::string frames = "index,t_s\n";
  for (int i = kLeftOut; i < kPictures; ++i) {
    frames += fmt::format("{},{}\n", i, 500 + static_cast<double>(i) / kRate);
  }
  folder.write("session/session.toml", "device = \"flashes\"\n");
  folder.write("session/frames.csv", frames);
  write_flashes(folder.path() / "raw");
  test::run_pipeline(fmt::format(
      "{} name=muxer ! filesink location={} filesrc location={} blocksize={} ! "
      "rawvideoparse width={} height={} format=i420 framerate={}/1 ! {} ! muxer. "
      "audiotestsrc num-buffers=250 samplesperbuffer=960 wave=ticks freq=3000 volume=0.9 "
      "sine-periods-per-tick=30 ! audio/x-raw,rate=48000,channels=1 ! audioconvert ! {} ! muxer.",
      GetParam().muxer, (session / GetParam().file).string(), (folder.path() / "raw").string(),
      kWidth * kHeight * 3 / 2, kWidth, kHeight, kRate, GetParam().video_encoder,
      GetParam().audio_encoder));
  const std::vector<double> recorded = sound_after_flash(session / GetParam().file);
  ASSERT_GE(recorded.size(), 4U);

  for (const char* name : {"out.mkv", "out.mp4"}) {
    const fs::path out = folder.path() / name;
    const auto run =
        test::run_program({GIMBALCTL, "stabilize", session.string(), "-o", out.string()}, kLimit_s);
    ASSERT_EQ(run.exit_status, 0) << run.standard_error;
    const std::vector<double> written = sound_after_flash(out);
    ASSERT_EQ(written.size(), 3U) << name;  // at 2, 3 and 4 s
    for (const double delay : written) EXPECT_NEAR(delay, recorded.back(), 0.003) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Recordings, AudioSync,
    ::testing::Values(Recording{"Matroska", "video.mkv", "matroskamux", "x264enc", "opusenc"},
                      Recording{"Mp4", "video.mp4", "mp4mux", "x264enc bframes=0", "avenc_aac"},
                      // Stored in another order than shown: the first picture's own stamp is not 0.
                      Recording{"Mp4WithBFrames", "video.mp4", "mp4mux",
                                "x264enc bframes=3 b-adapt=false", "avenc_aac"}),
    [](const auto& recording) -> std::string { return recording.param.name; });

}  // namespace
}  // namespace gimbal

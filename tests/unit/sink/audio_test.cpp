#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>
#include <string>
#include <vector>

#include "pipeline/sink/audio_branch.hpp"
#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/sink/gstreamer_sink.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

using ::testing::DoubleNear;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pointwise;

constexpr int kSampleRate = 48000;
constexpr auto kFrameInterval = std::chrono::milliseconds(100);

/// Four seconds of silence with a short burst of a tone at every full second, beside a video.
void make_recording(const std::filesystem::path& path, const std::string& audio_encoder,
                    const std::string& muxer) {
  test::run_pipeline(fmt::format(
      "{} name=muxer ! filesink location={} "
      "videotestsrc num-buffers=40 ! video/x-raw,width=64,height=48,framerate=10/1 ! x264enc ! "
      "muxer. "
      "audiotestsrc num-buffers=200 samplesperbuffer=960 wave=ticks freq=3000 volume=0.9 "
      "sine-periods-per-tick=30 ! audio/x-raw,rate={},channels=1 ! audioconvert ! {} ! muxer.",
      muxer, path.string(), kSampleRate, audio_encoder));
}

Result<std::vector<std::string>> write_with_audio(const std::filesystem::path& out,
                                                  const AudioTrack& audio) {
  constexpr ImageSize kSize{64, 48};
  auto sink = open_sink(out, {kSize, 10, {}}, audio);
  if (!sink) {
    return tl::unexpected(sink.error());
  }
  for (int index = 0; index < 40; ++index) {
    const SensorTime time(std::chrono::hours(5) + index * kFrameInterval);
    if (auto written = (*sink)->write(test::test_picture(kSize, {index, time, {}})); !written) {
      return tl::unexpected(written.error());
    }
  }
  if (auto finished = (*sink)->finish(); !finished) {
    return tl::unexpected(finished.error());
  }
  return (*sink)->warnings();
}

std::vector<std::vector<std::uint8_t>> coded_stream(const std::filesystem::path& path,
                                                    const std::string& demuxer,
                                                    const std::string& pad) {
  std::vector<std::vector<std::uint8_t>> packets;
  for (auto& buffer : test::play(fmt::format("filesrc location={} ! {} name=d d.{} ! queue ! "
                                             "appsink name=out",
                                             path.string(), demuxer, pad))
                          .buffers) {
    packets.push_back(std::move(buffer.bytes));
  }
  return packets;
}

struct AudioCase {
  const char* name;
  const char* encoder;
  const char* recording_muxer;
  const char* recording_demuxer;
  const char* output;
  bool is_unchanged;
};

void PrintTo(const AudioCase& audio, std::ostream* out) {
  *out << audio.name;
}

constexpr AudioCase kCases[] = {
    {"AacToMp4", "avenc_aac", "mp4mux", "qtdemux", "out.mp4", true},
    {"AacToMatroska", "avenc_aac", "mp4mux", "qtdemux", "out.mkv", true},
    {"OpusToMp4", "opusenc", "matroskamux", "matroskademux", "out.mp4", true},
    {"Mp3ToMp4", "lamemp3enc", "matroskamux", "matroskademux", "out.mp4", true},
    {"PcmToMatroska", "identity", "matroskamux", "matroskademux", "out.mkv", true},
    {"PcmToMp4", "identity", "matroskamux", "matroskademux", "out.mp4", false},
    {"VorbisToMp4", "vorbisenc", "matroskamux", "matroskademux", "out.mp4", false},
};

class AudioTest : public ::testing::TestWithParam<AudioCase> {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path recording_ = folder_.path() / "recording";
  std::filesystem::path out_ = folder_.path() / GetParam().output;

  void SetUp() override {
    make_recording(recording_, GetParam().encoder, GetParam().recording_muxer);
  }
  [[nodiscard]] std::string output_demuxer() const {
    return out_.extension() == ".mp4" ? "qtdemux" : "matroskademux";
  }
};

TEST_P(AudioTest, StaysInSync) {
  const std::vector<double> in_recording = test::sound_onsets(recording_);
  ASSERT_GE(in_recording.size(), 3U);
  for (const auto offset : {std::chrono::milliseconds(0), std::chrono::milliseconds(350),
                            std::chrono::milliseconds(-650)}) {
    const auto warnings = write_with_audio(out_, {recording_, offset});
    ASSERT_TRUE(warnings) << warnings.error().message;
    std::vector<double> expected;
    for (const double time : in_recording) {
      const double shifted = time + 1e-3 * static_cast<double>(offset.count());
      if (shifted > 0.1 && shifted < 3.5) {
        expected.push_back(shifted);
      }
    }
    std::vector<double> heard = test::sound_onsets(out_);
    std::erase_if(heard, [](double time) { return time <= 0.1 || time >= 3.5; });
    EXPECT_THAT(heard, Pointwise(DoubleNear(0.003), expected))
        << "offset " << offset.count() << " ms";
  }
}

TEST_P(AudioTest, GoesUnchangedWhereTheContainerTakesIt) {
  const auto warnings = write_with_audio(out_, {recording_, std::chrono::milliseconds(-650)});
  ASSERT_TRUE(warnings) << warnings.error().message;
  if (!GetParam().is_unchanged) {
    ASSERT_EQ(warnings->size(), 1U);
    EXPECT_THAT(warnings->front(), HasSubstr("encoded again as AAC"));
    return;
  }
  EXPECT_THAT(*warnings, IsEmpty());
  auto recorded = coded_stream(recording_, GetParam().recording_demuxer, "audio_0");
  const auto written = coded_stream(out_, output_demuxer(), "audio_0");
  ASSERT_LT(written.size(), recorded.size());
  ASSERT_GT(written.size(), recorded.size() / 2);
  recorded.erase(recorded.begin(), recorded.end() - std::ssize(written));
  EXPECT_EQ(written, recorded);
}

INSTANTIATE_TEST_SUITE_P(Codecs, AudioTest, ::testing::ValuesIn(kCases),
                         [](const auto& audio) -> std::string { return audio.param.name; });

TEST(DamagedAudioTest, PicturesAreWrittenToTheEnd) {
  const test::TemporaryFolder folder;
  const auto recording = folder.path() / "recording.mkv";
  make_recording(recording, "opusenc", "matroskamux");
  std::filesystem::resize_file(recording, std::filesystem::file_size(recording) / 2);
  const auto out = folder.path() / "out.mp4";
  const auto warnings = write_with_audio(out, {recording, {}});
  ASSERT_TRUE(warnings) << warnings.error().message;
  EXPECT_EQ(coded_stream(out, "qtdemux", "video_0").size(), 40U);
  EXPECT_GT(coded_stream(out, "qtdemux", "audio_0").size(), 50U);
}

TEST(DamagedAudioTest, NoRecordingIsAWarning) {
  const test::TemporaryFolder folder;
  folder.write("text.mp4", "This is not a video.\n");
  for (const char* name : {"text.mp4", "missing.mp4"}) {
    const auto out = folder.path() / "out.mkv";
    const auto warnings = write_with_audio(out, {folder.path() / name, {}});
    ASSERT_TRUE(warnings) << warnings.error().message;
    ASSERT_EQ(warnings->size(), 1U);
    EXPECT_THAT(warnings->front(), HasSubstr("its audio is left out"));
    EXPECT_EQ(coded_stream(out, "matroskademux", "video_0").size(), 40U);
  }
}

TEST(DamagedAudioTest, ErrorOnTheWayEndsTheAudioOnly) {
  const test::TemporaryFolder folder;
  const auto recording = folder.path() / "recording.mkv";
  make_recording(recording, "opusenc", "matroskamux");
  const AudioTrack track{recording, {}};
  const auto out = folder.path() / "out.mkv";
  SinkPipeline target;
  target.pipeline = *parse_pipeline(fmt::format(
      "appsrc name={} ! jpegenc ! muxer.video_0 matroskamux name=muxer ! filesink location={} {}",
      kFrameSourceName, out.string(), plan_audio(track, "matroskamux").text));
  target.audio = std::make_unique<AudioBranch>(target.pipeline, track);
  const GstElementPtr parser = element_named(target.pipeline, "audio_parser");
  auto sink = GstreamerSink::start(std::move(target), {{64, 48}, 10, {}});
  ASSERT_TRUE(sink) << sink.error().message;
  for (int index = 0; index < 40; ++index) {
    if (index == 10) {
      gst_element_post_message(
          parser.get(),
          gst_message_new_error(GST_OBJECT(parser.get()),
                                g_error_new(GST_STREAM_ERROR, GST_STREAM_ERROR_DEMUX, "damaged"),
                                nullptr));
    }
    const SensorTime time(index * kFrameInterval);
    const auto written = (*sink)->write(test::test_picture({64, 48}, {index, time, {}}));
    ASSERT_TRUE(written) << written.error().message;
  }
  const auto finished = (*sink)->finish();
  ASSERT_TRUE(finished) << finished.error().message;
  ASSERT_EQ((*sink)->warnings().size(), 1U);
  EXPECT_THAT((*sink)->warnings()[0], HasSubstr("could not be read to its end"));
  EXPECT_EQ(coded_stream(out, "matroskademux", "video_0").size(), 40U);
}

}  // namespace
}  // namespace gimbal

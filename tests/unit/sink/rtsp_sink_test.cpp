#include "pipeline/sink/rtsp_sink.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <thread>

#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

constexpr ImageSize kSize{160, 120};
constexpr double kFps = 25;
constexpr std::uint8_t kLevel = 90;

SensorTime now() {
  return SensorTime(std::chrono::steady_clock::now().time_since_epoch());  // CLOCK_MONOTONIC here
}

VideoFrame grey_picture(std::int64_t index, SensorTime time) {
  Nv12Buffer picture(kSize);
  std::fill_n(picture.luma().data, picture.luma().stride_bytes * kSize.height, kLevel);
  std::fill_n(picture.chroma().data, picture.chroma().stride_bytes * kSize.height / 2,
              std::uint8_t{128});
  return std::move(picture).publish({index, time, std::nullopt}, {});
}

RtspSettings any_port() {
  RtspSettings settings;
  settings.port = 0;
  return settings;
}

SinkFormat live_format() {
  return {kSize, kFps, {}, LiveTiming{now(), milliseconds(200)}};
}

/// A camera that films into a sink until it is told to stop.
class Filming {
 public:
  explicit Filming(RtspSink& sink) : thread_([this, &sink] { run(sink); }) {}
  ~Filming() {
    stops_ = true;
    thread_.join();
  }

 private:
  void run(RtspSink& sink) {
    for (std::int64_t index = 0; !stops_; ++index) {
      EXPECT_TRUE(sink.write(grey_picture(index, now() - milliseconds(200))));
      std::this_thread::sleep_for(milliseconds(40));
    }
  }

  std::atomic<bool> stops_ = false;
  std::thread thread_;
};

test::Playback watch(const std::string& url, int pictures) {
  return test::play(
      fmt::format("rtspsrc location={} protocols=tcp latency=0 buffer-mode=none ! rtph264depay ! "
                  "avdec_h264 ! videoconvert ! "
                  "video/x-raw,format=NV12 ! identity eos-after={} ! appsink name=out",
                  url, pictures + 1));
}

TEST(RtspSink, ClientsSeeThePictures) {
  auto sink = RtspSink::start(any_port(), live_format());
  ASSERT_TRUE(sink) << sink.error().message;
  const Filming filming(**sink);
  for (int visit = 0; visit < 2; ++visit) {  // the encoder ends with the first visit
    const auto playback = watch((*sink)->url(), 20);
    ASSERT_EQ(playback.buffers.size(), 20U) << visit;
    for (std::size_t i = 0; i < playback.buffers.size(); ++i) {
      EXPECT_NEAR(playback.buffers[i].bytes[0], kLevel, 4);
      if (i > 0) {
        EXPECT_GT(playback.buffers[i].running_time_ns, playback.buffers[i - 1].running_time_ns);
      }
    }
  }
}

TEST(RtspSink, TwoClientsShareAStream) {
  auto sink = RtspSink::start(any_port(), live_format());
  ASSERT_TRUE(sink) << sink.error().message;
  const Filming filming(**sink);
  std::size_t seen_by_other = 0;
  std::thread other([&] { seen_by_other = watch((*sink)->url(), 15).buffers.size(); });
  EXPECT_EQ(watch((*sink)->url(), 15).buffers.size(), 15U);
  other.join();
  EXPECT_EQ(seen_by_other, 15U);
}

TEST(RtspSink, ClientsHearTheSoundBesideThePictures) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "heard.mkv";
  RtspSettings settings = any_port();
  settings.audio =
      "audiotestsrc is-live=true samplesperbuffer=960 wave=ticks freq=3000 volume=0.9 "
      "sine-periods-per-tick=30 ! audio/x-raw,rate=48000,channels=1";
  auto sink = RtspSink::start(settings, live_format());
  ASSERT_TRUE(sink) << sink.error().message;
  const Filming filming(**sink);
  test::run_pipeline(fmt::format(
      "rtspsrc name=in location={} protocols=tcp latency=0 matroskamux name=muxer ! filesink "
      "location={} in. ! rtph264depay ! h264parse ! identity eos-after=100 ! muxer. "
      "in. ! rtpopusdepay ! opusparse ! identity eos-after=200 ! muxer.",
      (*sink)->url(), file.string()));
  const auto heard = test::sound_onsets(file);
  ASSERT_GE(heard.size(), 3U);  // in 4 s
  for (std::size_t i = 1; i < heard.size(); ++i) EXPECT_NEAR(heard[i] - heard[i - 1], 1, 0.1);
}

TEST(RtspSink, WritesWithoutClientsAndEndsAtOnce) {
  auto sink = RtspSink::start(any_port(), live_format());
  ASSERT_TRUE(sink) << sink.error().message;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE((*sink)->write(grey_picture(i, now())));
  EXPECT_TRUE((*sink)->finish());
}

TEST(RtspSink, APortThatIsTakenIsNamed) {
  auto first = RtspSink::start(any_port(), live_format());
  ASSERT_TRUE(first);
  const std::string url = (*first)->url();
  RtspSettings settings;
  settings.port = std::stoi(url.substr(url.rfind(':') + 1));
  const auto second = RtspSink::start(settings, live_format());
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr(std::to_string(settings.port)));
}

}  // namespace
}  // namespace gimbal

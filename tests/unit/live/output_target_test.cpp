#include "daemon/output_target.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <thread>
#include <vector>

#include "drivers/clock/monotonic_now.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::Each;
using ::testing::SizeIs;

constexpr ImageSize kSize{64, 48};
constexpr double kFps = 25;
constexpr SensorDuration kInterval = milliseconds(40);
constexpr SensorDuration kDelay = milliseconds(400);
constexpr std::uint8_t kDark = 16;
constexpr std::uint8_t kBright = 235;

VideoFrame grey_picture(std::int64_t index, SensorTime time, std::uint8_t level) {
  Nv12Buffer picture(kSize);
  std::fill_n(picture.luma().data, picture.luma().stride_bytes * kSize.height, level);
  std::fill_n(picture.chroma().data, picture.chroma().stride_bytes * kSize.height / 2,
              std::uint8_t{128});
  return std::move(picture).publish({index, time, std::nullopt}, {});
}

/// Bright for a tenth of each full second since the first picture was taken.
std::uint8_t level_at(SensorDuration since_first) {
  return since_first % seconds(1) < milliseconds(100) ? kBright : kDark;
}

/// Takes pictures for a while, and offers each a steady lag after it was taken.
Result<void> film(const OutputSettings& settings, int pictures) {
  const SensorTime first = monotonic_now();
  auto sink = target_of(settings).open({kSize, kFps, {}, LiveTiming{first, kDelay}});
  if (!sink) return tl::unexpected(sink.error());
  for (int i = 0; i < pictures; ++i) {
    const SensorTime taken = first + i * kInterval;
    std::this_thread::sleep_for(taken + kDelay - monotonic_now());
    auto written = (*sink)->write(grey_picture(i, taken, level_at(taken - first)));
    if (!written) return written;
  }
  return (*sink)->finish();
}

std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

test::Playback play_file(const std::filesystem::path& path) {
  return test::play(fmt::format(
      "filesrc location={} ! decodebin ! videoconvert ! video/x-raw,format=NV12 ! appsink name=out",
      path.string()));
}

/// When the picture turns bright, in seconds.
std::vector<double> flashes(const std::filesystem::path& path) {
  std::vector<double> found;
  bool was_bright = false;
  for (const auto& buffer : play_file(path).buffers) {
    const bool is_bright = buffer.bytes[0] > (kDark + kBright) / 2;
    if (is_bright && !was_bright) {
      found.push_back(1e-9 * static_cast<double>(buffer.running_time_ns));
    }
    was_bright = is_bright;
  }
  return found;
}

TEST(SegmentOutput, EachFilePlaysAndNoPictureIsLost) {
  const test::TemporaryFolder folder;
  SegmentOutput output;
  output.folder = folder.path() / "deep/video";
  output.length = seconds(1);
  constexpr int kPictures = 65;
  const auto filmed = film(output, kPictures);
  ASSERT_TRUE(filmed) << filmed.error().message;
  std::size_t pictures = 0;
  const auto files = files_in(output.folder);
  EXPECT_THAT(files, SizeIs(3));
  for (const auto& file : files) pictures += play_file(file).buffers.size();
  EXPECT_EQ(pictures, kPictures);
}

TEST(SegmentOutput, KeepsTheNewestOnly) {
  const test::TemporaryFolder folder;
  SegmentOutput output;
  output.folder = folder.path();
  output.length = seconds(1);
  output.kept = 2;
  ASSERT_TRUE(film(output, 85));
  EXPECT_THAT(files_in(folder.path()), SizeIs(2));
}

TEST(SegmentOutput, SoundComesWithThePicturesThatWereTakenWithIt) {
  const test::TemporaryFolder folder;
  // Where in its first packet the encoder is when the source begins is chance.
  constexpr double kPacket_s = 0.020;
  const std::string sound =
      " samplesperbuffer=960 wave=ticks freq=3000 volume=0.9 sine-periods-per-tick=30 "
      "! audio/x-raw,rate=48000,channels=1";
  // When the source ticks, which is not quite at full seconds.
  const auto truth_file = folder.path() / "truth.wav";
  test::run_pipeline(fmt::format("audiotestsrc num-buffers=200{} ! wavenc ! filesink location={}",
                                 sound, truth_file.string()));
  const auto ticks = test::sound_onsets(truth_file);
  ASSERT_GE(ticks.size(), 3U);

  SegmentOutput output;
  output.folder = folder.path() / "video";
  output.audio = "audiotestsrc is-live=true" + sound;
  const auto filmed = film(output, 110);
  ASSERT_TRUE(filmed) << filmed.error().message;
  const auto file = files_in(output.folder).at(0);
  const auto seen = flashes(file);
  const auto heard = test::sound_onsets(file);
  ASSERT_GE(seen.size(), 3U);
  ASSERT_GE(heard.size(), 3U);
  // It counts its samples from when it gets going, which a busy machine puts off; a whole lag it is
  // not.
  const double begun_late_s = heard[0] - ticks[0];
  EXPECT_GT(begun_late_s, -kPacket_s);
  EXPECT_LT(begun_late_s, to_seconds(kDelay) / 2);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(seen[i], static_cast<double>(i), 0.002);
    EXPECT_NEAR(heard[i] - ticks[i], begun_late_s, 0.002);
  }
}

TEST(PipelineOutput, AClockedSinkShowsPicturesTheDelayAfterTheyWereTaken) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "pictures";
  const SensorTime begin = monotonic_now();
  // The sink waits for each picture's time, so the end cannot come before the last one's.
  const auto filmed =
      film(TextOutput{fmt::format("identity ! filesink sync=true location={}", file.string())}, 10);
  ASSERT_TRUE(filmed) << filmed.error().message;
  EXPECT_GE(monotonic_now() - begin, 9 * kInterval + kDelay);
  EXPECT_EQ(std::filesystem::file_size(file), 10U * kSize.width * kSize.height * 3 / 2);
}

TEST(ShmOutput, AnotherProgramReadsThePictures) {
  const test::TemporaryFolder folder;
  const ShmOutput output{folder.path() / "video"};
  Result<void> filmed;
  std::thread filming([&] { filmed = film(output, 50); });
  while (!std::filesystem::exists(output.socket)) std::this_thread::sleep_for(milliseconds(10));
  const auto playback = test::play(fmt::format(
      "shmsrc socket-path={} is-live=true do-timestamp=true num-buffers=5 ! appsink name=out",
      output.socket.string()));
  filming.join();
  EXPECT_TRUE(filmed) << filmed.error().message;
  ASSERT_THAT(playback.buffers, SizeIs(5));
  for (const auto& buffer : playback.buffers) {
    EXPECT_THAT(buffer.bytes, SizeIs(kSize.width * kSize.height * 3 / 2));
    EXPECT_TRUE(buffer.bytes[0] == kDark || buffer.bytes[0] == kBright);
  }
}

/// As a process that was killed leaves it.
void leave_a_socket(const std::filesystem::path& path) {
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)), 0);
  ::close(socket);
}

TEST(ShmOutput, TakesThePlaceOfASocketThatWasLeftBehind) {
  const test::TemporaryFolder folder;
  const ShmOutput output{folder.path() / "video"};
  leave_a_socket(output.socket);
  ASSERT_TRUE(film(output, 3));
  EXPECT_THAT(files_in(folder.path()), Each(::testing::Ne(folder.path() / "video.0")));
}

TEST(UdpOutput, AnRtpReceiverSeesThePictures) {
  UdpOutput output;
  output.port = 23451;
  Result<void> filmed;
  std::thread filming([&] { filmed = film(output, 60); });
  const auto playback = test::play(
      "udpsrc port=23451 num-buffers=40 caps=\"application/x-rtp,media=video,clock-rate=90000,"
      "encoding-name=H264,payload=96\" ! rtph264depay ! avdec_h264 ! videoconvert ! "
      "video/x-raw,format=NV12 ! appsink name=out");
  filming.join();
  EXPECT_TRUE(filmed) << filmed.error().message;
  ASSERT_GT(playback.buffers.size(), 10U);
  EXPECT_NEAR(playback.buffers[0].bytes[0], playback.buffers[0].bytes[0] > 100 ? kBright : kDark,
              8);
}

}  // namespace
}  // namespace gimbal

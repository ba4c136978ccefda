#include "drivers/replay/replay_camera.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <ostream>
#include <sstream>
#include <thread>

#include "pipeline/pixels/nv12_frame.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/gst_registry.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

using test::irregular_stamps;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A lossless 64x48 video whose luma pixels are known, at 10 pictures a second, made without the
/// code under test: raw pictures are put into a file and encoded from there.
void make_lossless_video(const std::filesystem::path& path, int count, const std::string& encoder) {
  const std::filesystem::path raw = path.string() + ".raw";
  std::ofstream file(raw, std::ios::binary);
  for (int frame = 0; frame < count; ++frame) {
    for (const int plane : {0, 1, 2}) {
      const auto bytes =
          test::packed_plane(frame, plane, plane == 0 ? 64 : 32, plane == 0 ? 48 : 24);
      file.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
    }
  }
  file.close();
  test::run_pipeline(
      fmt::format("filesrc location={} blocksize={} ! rawvideoparse width=64 height=48 "
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

TEST_P(LosslessVideoTest, NothingOfI420MovesWhereNativePicturesAreWanted) {
  const auto path = folder_.path() / "video.mkv";
  make_lossless_video(path, 3, std::string(GetParam()) + " ! matroskamux");
  ReplayCamera camera(path, irregular_stamps(3), 0);
  ASSERT_TRUE(camera.start());
  camera.ask_for(PictureForm::native);
  const auto frames = read_all(camera);
  ASSERT_EQ(frames.size(), 3U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_TRUE(frames[i].native);
    EXPECT_EQ(frames[i].native->format, NativeFormat::i420);
    expect_picture(as_nv12(frames[i]), static_cast<std::int64_t>(i));
  }
  EXPECT_EQ(camera.bytes_copied(), 0);
}

INSTANTIATE_TEST_SUITE_P(Encoders, LosslessVideoTest,
                         ::testing::Values("identity", "avenc_ffv1",
                                           "x264enc pass=quant quantizer=0"));

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

struct Coding {
  const char* elements;
  const char* file;
};

void PrintTo(const Coding& coding, std::ostream* out) {
  *out << coding.elements;
}

class RewindTest : public ::testing::TestWithParam<Coding> {};

/// From the end and from the middle. Of a file that cannot be sought in as well: it is opened anew.
TEST_P(RewindTest, TheVeryPicturesComeAgain) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / GetParam().file;
  make_lossless_video(path, 12, GetParam().elements);
  const auto stamps = irregular_stamps(12);
  ReplayCamera camera(path, stamps, 10);
  const auto started = camera.start();
  ASSERT_TRUE(started) << started.error().message;
  ASSERT_EQ(read_all(camera).size(), stamps.size());
  for (const int frames_read : {12, 1, 0, 7}) {
    const auto rewound = camera.rewind();
    ASSERT_TRUE(rewound) << rewound.error().message;
    for (int i = 0; i < frames_read; ++i) {
      const auto frame = camera.read();
      ASSERT_TRUE(frame && *frame) << i;
      EXPECT_EQ((*frame)->stamp.time, stamps[static_cast<std::size_t>(i)].time);
      expect_picture(**frame, i);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Codings, RewindTest,
    ::testing::Values(Coding{"x264enc pass=quant quantizer=0 bframes=2 ! matroskamux", "video.mkv"},
                      Coding{"x264enc pass=quant quantizer=0 bframes=2 ! mp4mux", "video.mp4"},
                      Coding{"x264enc pass=quant quantizer=0 ! h264parse ! mpegtsmux", "video.ts"},
                      Coding{"avenc_ffv1 ! matroskamux", "video.mkv"},
                      Coding{"identity ! avimux", "video.avi"}, Coding{"y4menc", "video.y4m"}));

TEST(ReplayCamera, NothingComesOfARewindAfterStop) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.mkv";
  make_lossless_video(path, 8, "avenc_ffv1 ! matroskamux");
  ReplayCamera camera(path, irregular_stamps(8), 0);
  ASSERT_TRUE(camera.start());
  camera.stop();
  ASSERT_TRUE(camera.rewind());
  EXPECT_EQ(*camera.read(), std::nullopt);
}

class ReplayCameraTest : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path video_ = folder_.path() / "video.mkv";

  void SetUp() override { make_lossless_video(video_, 12, "avenc_ffv1 ! matroskamux"); }
};

TEST_F(ReplayCameraTest, LongerFrameListIsCountedAndSaid) {
  ReplayCamera camera(video_, irregular_stamps(15), 0);
  ASSERT_TRUE(camera.start());
  EXPECT_EQ(read_all(camera).size(), 12U);
  EXPECT_EQ(camera.stamps_without_frame(), 3);
  EXPECT_EQ(camera.frames_without_stamp(), 0);
  ASSERT_EQ(camera.warnings().size(), 1U);
  EXPECT_THAT(camera.warnings()[0], HasSubstr("no picture for the last 3 stamps"));
}

TEST_F(ReplayCameraTest, ShorterFrameListLeavesPicturesOut) {
  ReplayCamera camera(video_, irregular_stamps(5), 0);
  ASSERT_TRUE(camera.start());
  EXPECT_EQ(read_all(camera).size(), 5U);
  EXPECT_EQ(camera.frames_without_stamp(), 7);
  EXPECT_EQ(camera.stamps_without_frame(), 0);
  ASSERT_EQ(camera.warnings().size(), 1U);
  EXPECT_THAT(camera.warnings()[0], HasSubstr("7 pictures have no stamp"));
}

TEST_F(ReplayCameraTest, RateOfTheSessionGoesBeforeTheVideos) {
  ReplayCamera camera(video_, irregular_stamps(12), 29.5);
  ASSERT_TRUE(camera.start());
  EXPECT_DOUBLE_EQ(camera.format().fps, 29.5);
}

TEST_F(ReplayCameraTest, FramesOutliveTheCamera) {
  std::vector<VideoFrame> frames;
  {
    ReplayCamera camera(video_, irregular_stamps(12), 0);
    ASSERT_TRUE(camera.start());
    frames = read_all(camera);
  }
  ASSERT_EQ(frames.size(), 12U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    expect_picture(frames[i], static_cast<std::int64_t>(i));
  }
}

TEST_F(ReplayCameraTest, StopWakesAWaitingReader) {
  ReplayCamera camera(video_, irregular_stamps(12), 0);
  ASSERT_TRUE(camera.start());
  std::thread stopper([&] { camera.stop(); });
  for (;;) {  // ends by itself or by the other thread, whichever comes first
    const auto frame = camera.read();
    ASSERT_TRUE(frame) << frame.error().message;
    if (!*frame) {
      break;
    }
  }
  stopper.join();
  EXPECT_EQ(*camera.read(), std::nullopt);
}

TEST(ReplayCameraErrorsTest, RefusesWhatIsNoVideo) {
  const test::TemporaryFolder folder;
  folder.write("text.mp4", "This is not a video.\n");
  folder.write("empty.mkv", "");
  folder.write("zeros.mp4", std::string(4096, '\0'));
  test::run_pipeline(
      fmt::format("audiotestsrc num-buffers=20 ! opusenc ! matroskamux ! filesink location={}",
                  (folder.path() / "sound.mkv").string()));
  ASSERT_EQ(::mkfifo((folder.path() / "pipe.mp4").c_str(), 0600), 0);
  for (const char* name :
       {"text.mp4", "empty.mkv", "zeros.mp4", "sound.mkv", "pipe.mp4", "missing.mp4", "."}) {
    ReplayCamera camera(folder.path() / name, irregular_stamps(3), 30);
    const auto started = camera.start();
    ASSERT_FALSE(started) << name;
    EXPECT_EQ(started.error().kind, Error::Kind::bad_input) << name;
    EXPECT_THAT(started.error().message, HasSubstr((folder.path() / name).string()));
    EXPECT_THAT(started.error().message, Not(HasSubstr("\n")));
    EXPECT_EQ(*camera.read(), std::nullopt) << name;
  }
}

TEST(ReplayCameraErrorsTest, NamesThePackageOfAMissingDecoder) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.mkv";
  make_lossless_video(path, 3, "avenc_ffv1 ! matroskamux");
  const test::WithoutElement no_ffv1("avdec_ffv1");
  ReplayCamera camera(path, irregular_stamps(3), 30);
  const auto started = camera.start();
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().kind, Error::Kind::bad_input);
  EXPECT_THAT(started.error().message, HasSubstr("apt install gstreamer1.0-libav"));
}

void overwrite_middle(const std::filesystem::path& video, int bytes) {
  std::fstream file(video, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(video) / 2));
  file << std::string(static_cast<std::size_t>(bytes), '\xa5');
}

bool is_picture(const VideoFrame& frame, std::int64_t index) {
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const auto luma = frame.planes[0].data[y * frame.planes[0].stride_bytes + x];
      if (luma != test::sample_of(index, 0, x, y)) return false;
    }
  }
  return true;
}

class LostPicturesTest : public ::testing::TestWithParam<const char*> {};

TEST_P(LostPicturesTest, LeaveTheOthersTheirStamps) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.mp4";
  make_lossless_video(path, 60, std::string(GetParam()) + " ! mp4mux");
  overwrite_middle(path, 3000);
  const auto stamps = irregular_stamps(60);
  ReplayCamera camera(path, stamps, 10);
  const auto started = camera.start();
  ASSERT_TRUE(started) << started.error().message;

  const auto frames = read_all(camera);
  ASSERT_LT(frames.size(), 60U) << "nothing is lost, so that nothing is tested";
  std::vector<std::int64_t> intact;
  for (const VideoFrame& frame : frames) {
    const auto index = static_cast<std::size_t>(frame.stamp.index);
    EXPECT_EQ(frame.stamp.time, stamps[index].time);
    if (is_picture(frame, frame.stamp.index)) intact.push_back(frame.stamp.index);
  }
  // What is wrong reaches from one key frame to the next, and perhaps over the one after that.
  EXPECT_GE(intact.size(), 45U);
  EXPECT_EQ(std::count_if(intact.begin(), intact.end(), [](auto index) { return index >= 45; }),
            15);
  EXPECT_EQ(camera.stamps_without_frame(), 60 - std::ssize(frames));
  EXPECT_THAT(camera.warnings(), Contains(HasSubstr("cannot be decoded")));
}

INSTANTIATE_TEST_SUITE_P(
    Order, LostPicturesTest,
    ::testing::Values("x264enc pass=quant quantizer=0 key-int-max=5 bframes=0",
                      "x264enc pass=quant quantizer=0 key-int-max=5 bframes=2"));

TEST(LostPictures, ThatNoTimesTellApartAreWarnedOf) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.avi";  // its H.264 has no presentation times
  make_lossless_video(path, 60, "x264enc pass=quant quantizer=0 key-int-max=5 bframes=0 ! avimux");
  overwrite_middle(path, 3000);
  ReplayCamera camera(path, irregular_stamps(60), 10);
  ASSERT_TRUE(camera.start());
  EXPECT_LT(read_all(camera).size(), 60U);
  EXPECT_THAT(camera.warnings(), Contains(HasSubstr("no times that tell which")));
}

/// Takes the middle one of a Matroska file's clusters out, as if it had been overwritten.
void remove_middle_cluster(const std::filesystem::path& video) {
  const std::string kCluster = "\x1f\x43\xb6\x75";
  std::ostringstream content;
  content << std::ifstream(video, std::ios::binary).rdbuf();
  std::string bytes = content.str();
  const std::size_t from = bytes.find(kCluster, bytes.size() / 2);
  ASSERT_NE(from, std::string::npos);
  bytes.erase(from, bytes.find(kCluster, from + 1) - from);
  std::ofstream(video, std::ios::binary) << bytes;
}

TEST(LostPictures, ThatAreGoneFromTheFileAreWarnedOf) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.mkv";
  make_lossless_video(path, 60, "avenc_ffv1 ! matroskamux max-cluster-duration=1000000000");
  remove_middle_cluster(path);
  ReplayCamera camera(path, irregular_stamps(60), 10);
  ASSERT_TRUE(camera.start());
  const auto lost = 60 - std::ssize(read_all(camera));
  ASSERT_GT(lost, 0);
  EXPECT_THAT(camera.warnings(),
              Contains(HasSubstr(fmt::format("its own times leap by {:.3f} s after picture 29",
                                             0.1 * static_cast<double>(lost + 1)))));
}

struct Damage {
  const char* name;
  const char* file;
  const char* encoder_and_muxer;
  bool can_start;  ///< an .mp4 has its index at the end
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.name;
}

class DamagedVideoTest : public ::testing::TestWithParam<Damage> {
 protected:
  test::TemporaryFolder folder_;
  std::filesystem::path video_ = folder_.path() / GetParam().file;

  void SetUp() override { make_lossless_video(video_, 60, GetParam().encoder_and_muxer); }
};

TEST_P(DamagedVideoTest, CutInHalfDeliversWhatIsThere) {
  std::filesystem::resize_file(video_, std::filesystem::file_size(video_) / 2);
  ReplayCamera camera(video_, irregular_stamps(60), 10);
  const auto started = camera.start();
  if (!GetParam().can_start) {
    ASSERT_FALSE(started);
    EXPECT_EQ(started.error().kind, Error::Kind::bad_input);
    return;
  }
  ASSERT_TRUE(started) << started.error().message;
  const auto frames = read_all(camera);
  EXPECT_GT(frames.size(), 20U);
  EXPECT_LT(frames.size(), 40U);
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {  // the last one may be cut itself
    expect_picture(frames[i], static_cast<std::int64_t>(i));
  }
  EXPECT_EQ(camera.stamps_without_frame(), 60 - std::ssize(frames));
  EXPECT_FALSE(camera.warnings().empty());
}

TEST_P(DamagedVideoTest, GarbageInTheMiddleEndsSomehow) {
  overwrite_middle(video_, 3000);
  ReplayCamera camera(video_, irregular_stamps(60), 10);
  const auto started = camera.start();
  ASSERT_TRUE(started) << started.error().message;
  std::size_t count = 0;
  std::int64_t last_index = -1;
  for (auto frame = camera.read(); frame && *frame; frame = camera.read()) {
    EXPECT_GT((*frame)->stamp.index, last_index);
    last_index = (*frame)->stamp.index;
    ++count;
  }
  EXPECT_GT(count, 20U);
  EXPECT_LE(count, 60U);
  RecordProperty("pictures", static_cast<int>(count));
}

INSTANTIATE_TEST_SUITE_P(
    Containers, DamagedVideoTest,
    ::testing::Values(
        Damage{"H264InMp4", "video.mp4", "x264enc pass=quant quantizer=0 ! mp4mux", false},
        Damage{"H264InFragmentedMp4", "video.mp4",
               "x264enc pass=quant quantizer=0 key-int-max=5 ! mp4mux fragment-duration=500 "
               "streamable=true",
               true},
        Damage{"H264InMatroska", "video.mkv", "x264enc pass=quant quantizer=0 ! matroskamux", true},
        Damage{"Ffv1InMatroska", "video.mkv", "avenc_ffv1 ! matroskamux", true},
        Damage{"RawInAvi", "video.avi", "avimux", true}),
    [](const auto& damage) -> std::string { return damage.param.name; });

TEST(ReplayCameraErrorsTest, ChangeOfSizeIsAnError) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.h264";
  for (const char* size : {"width=64,height=48", "width=96,height=64"}) {
    test::run_pipeline(
        fmt::format("videotestsrc num-buffers=5 ! video/x-raw,{},framerate=10/1 ! x264enc "
                    "! video/x-h264,stream-format=byte-stream ! filesink location={} append=true",
                    size, path.string()));
  }
  ReplayCamera camera(path, irregular_stamps(10), 10);
  ASSERT_TRUE(camera.start());
  auto frame = camera.read();
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(frame && *frame) << i;
    frame = camera.read();
  }
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().kind, Error::Kind::bad_input);
  EXPECT_THAT(frame.error().message, HasSubstr("96x64, but the first was 64x48"));
}

}  // namespace
}  // namespace gimbal

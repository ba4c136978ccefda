#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gst/video/video.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <ostream>

#include "pipeline/sink/frame_sink.hpp"
#include "pipeline/sink/gstreamer_sink.hpp"
#include "tests/support/gst_playback.hpp"
#include "tests/support/gst_registry.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/test_pictures.hpp"

namespace gimbal {
namespace {

using test::irregular_stamps;
using test::test_picture;
using test::WithoutElement;
using ::testing::HasSubstr;
using ::testing::Not;

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
  const char* name;
  const char* extension;
  double fps;  ///< 0: unknown
  std::int64_t grain_ns;
};

void PrintTo(const Container& container, std::ostream* out) {
  *out << container.name;
}

class PresentationTimeTest : public ::testing::TestWithParam<Container> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(PresentationTimeTest, CaptureTimesBecomePresentationTimes) {
  const auto path = folder_.path() / (std::string("out") + GetParam().extension);
  const auto stamps = irregular_stamps(60);
  const auto written = write_pictures(path, {kSize, GetParam().fps, {}}, stamps);
  ASSERT_TRUE(written) << written.error().message;

  const test::Playback playback = play_file(path);
  ASSERT_EQ(playback.buffers.size(), stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const auto expected = (stamps[i].time - stamps[0].time).count();
    EXPECT_LE(std::abs(playback.buffers[i].running_time_ns - expected), GetParam().grain_ns) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Containers, PresentationTimeTest,
                         ::testing::Values(Container{"Mp4", ".mp4", 30, 1'000'000'000 / 90'000 + 1},
                                           Container{"Matroska", ".mkv", 30, 100'000},
                                           Container{"Mp4OfUnknownRate", ".mp4", 0,
                                                     1'000'000'000 / 90'000 + 1},
                                           Container{"MatroskaOfUnknownRate", ".mkv", 0, 100'000}),
                         [](const auto& container) -> std::string { return container.param.name; });

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

TEST(Y4mTest, NothingCanBeWrittenAfterTheEnd) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "out.y4m";
  auto sink = open_sink(path, {kSize, 25, {}}, std::nullopt);
  ASSERT_TRUE(sink);
  ASSERT_TRUE((*sink)->write(test_picture(kSize, irregular_stamps(1)[0])));
  ASSERT_TRUE((*sink)->finish());
  const std::string written = bytes_of(path);
  EXPECT_FALSE((*sink)->write(test_picture(kSize, irregular_stamps(2)[1])));
  EXPECT_EQ(bytes_of(path), written);
}

/// Puts another file in the place of standard output for as long as it lives.
class StandardOutput {
 public:
  explicit StandardOutput(int replacement) : before_(::dup(STDOUT_FILENO)) {
    std::fflush(stdout);
    ::dup2(replacement, STDOUT_FILENO);
  }
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;
  ~StandardOutput() {
    std::fflush(stdout);
    ::dup2(before_, STDOUT_FILENO);
    ::close(before_);
  }

 private:
  int before_;
};

TEST(Y4mTest, StandardOutputGetsTheSameAndNothingElse) {
  const test::TemporaryFolder folder;
  const SinkFormat format{{48, 32}, 25, {}};
  const auto stamps = irregular_stamps(4);
  ASSERT_TRUE(write_pictures(folder.path() / "file.y4m", format, stamps));
  const auto path = folder.path() / "stdout.y4m";
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT, 0600);
  Result<void> written;
  {
    const StandardOutput output(file);
    g_print("GLib's own printing does not belong between pictures\n");
    written = write_pictures("-", format, stamps);
  }
  ::close(file);
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(bytes_of(path), bytes_of(folder.path() / "file.y4m"));
}

TEST(Y4mTest, ReaderThatGoesAwayIsAnErrorAndNoSignal) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  Result<void> written;
  {
    const StandardOutput output(ends[1]);
    written = write_pictures("-", {kSize, 30, {}}, irregular_stamps(2));
  }
  ::close(ends[1]);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, Error::Kind::failed);
  EXPECT_THAT(written.error().message, HasSubstr("reader is gone after 0 frames"));
}

TEST(PipelineTest, TakesAnyPipelineText) {
  const auto written = write_pictures("identity ! fakesink", {kSize, 30, {}}, irregular_stamps(10));
  EXPECT_TRUE(written) << written.error().message;
}

TEST(PipelineTest, ConsumersOfPlainBytesGetPackedPictures) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "raw";
  constexpr ImageSize kNarrow{36, 20};  // Nv12Buffer pads its rows to 64 bytes, GStreamer to 4
  const auto written = write_pictures(fmt::format("identity ! filesink location={}", path.string()),
                                      {kNarrow, 30, {}}, irregular_stamps(2));
  ASSERT_TRUE(written) << written.error().message;
  std::string expected;
  for (const int frame : {0, 1}) {
    for (const auto& plane :
         {test::packed_plane(frame, 0, 36, 20), test::packed_plane(frame, 1, 36, 10)}) {
      expected.append(plane.begin(), plane.end());
    }
  }
  EXPECT_EQ(bytes_of(path), expected);
}

struct BadOutput {
  const char* name;
  const char* out;  ///< FOLDER is replaced
  Error::Kind kind;
  const char* message;
};

void PrintTo(const BadOutput& bad, std::ostream* out) {
  *out << bad.out;
}

class BadOutputTest : public ::testing::TestWithParam<BadOutput> {};

TEST_P(BadOutputTest, SaysInOneLineWhatIsWrong) {
  const test::TemporaryFolder folder;
  for (const char* name : {"full.mp4", "full.mkv", "full.y4m", "full.avi"}) {
    std::filesystem::create_symlink("/dev/full", folder.path() / name);
  }
  std::string out = GetParam().out;
  if (const auto place = out.find("FOLDER"); place != std::string::npos) {
    out.replace(place, 6, folder.path().string());
  }
  // More than buffers on the way can hold, so that a full disk shows while writing.
  const auto written = write_pictures(out, {kSize, 30, {}}, irregular_stamps(100));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, GetParam().kind) << written.error().message;
  EXPECT_THAT(written.error().message, HasSubstr(GetParam().message));
  EXPECT_THAT(written.error().message, Not(HasSubstr("\n")));
}

INSTANTIATE_TEST_SUITE_P(
    Outputs, BadOutputTest,
    ::testing::Values(
        BadOutput{"NoFolderMp4", "FOLDER/no/out.mp4", Error::Kind::bad_input, "there is no folder"},
        BadOutput{"NoFolderY4m", "FOLDER/no/out.y4m", Error::Kind::bad_input, "there is no folder"},
        BadOutput{"UnknownEnding", "FOLDER/out.avi", Error::Kind::bad_input, ".mp4, .mkv or .y4m"},
        BadOutput{"NoEnding", "FOLDER/out", Error::Kind::bad_input, ".mp4, .mkv or .y4m"},
        BadOutput{"FullMp4", "FOLDER/full.mp4", Error::Kind::failed, "is incomplete"},
        BadOutput{"FullMkv", "FOLDER/full.mkv", Error::Kind::failed, "ends where writing failed"},
        BadOutput{"FullY4m", "FOLDER/full.y4m", Error::Kind::failed, "No space left on device"},
        BadOutput{"FullPipeline", "jpegenc ! avimux ! filesink location=FOLDER/full.avi",
                  Error::Kind::failed, "filesink"},
        BadOutput{"NoSuchElement", "nosuchthing ! fakesink", Error::Kind::bad_input,
                  "no element \"nosuchthing\""},
        BadOutput{"NoSuchProperty", "identity nosuch=1 ! fakesink", Error::Kind::bad_input,
                  "nosuch"},
        BadOutput{"Syntax", "identity ! ! fakesink", Error::Kind::bad_input, "pipeline"},
        BadOutput{"CannotLink", "h264parse ! fakesink", Error::Kind::bad_input, "h264parse"},
        BadOutput{"NoConsumer", "identity ! identity", Error::Kind::failed, "not-linked"},
        BadOutput{"FailsLater", "identity error-after=5 ! fakesink", Error::Kind::failed,
                  "identity"},
        BadOutput{"EndsItself", "identity eos-after=5 ! fakesink", Error::Kind::failed,
                  "ended before the pictures did"}),
    [](const auto& bad) -> std::string { return bad.param.name; });

TEST(PipelineTest, StandstillIsAnError) {
  ASSERT_TRUE(init_gstreamer());
  SinkPipeline target;
  // The muxer waits for its second input for ever.
  target.pipeline =
      *parse_pipeline(fmt::format("appsrc name={} ! jpegenc ! matroskamux name=muxer ! fakesink "
                                  "appsrc caps=audio/x-raw ! muxer.",
                                  kFrameSourceName));
  target.patience = std::chrono::milliseconds(50);
  auto sink = GstreamerSink::start(std::move(target), {kSize, 30, {}});
  ASSERT_TRUE(sink) << sink.error().message;
  Result<void> written;
  for (const FrameStamp& stamp : irregular_stamps(30)) {
    if (written = (*sink)->write(test_picture(kSize, stamp)); !written) {
      break;
    }
  }
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("took nothing for 0.05 s"));
  const auto finished = (*sink)->finish();
  ASSERT_FALSE(finished);
}

/// Where each buffer's first plane lies, for a consumer that respects strides.
struct PlaneAddresses {
  std::vector<const void*> seen;

  static GstPadProbeReturn on_item(GstPad* /*pad*/, GstPadProbeInfo* info, gpointer self) {
    if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) != 0) {
      GstMapInfo map;
      GstMemory* memory = gst_buffer_peek_memory(GST_PAD_PROBE_INFO_BUFFER(info), 0);
      gst_memory_map(memory, &map, GST_MAP_READ);
      static_cast<PlaneAddresses*>(self)->seen.push_back(map.data);
      gst_memory_unmap(memory, &map);
      return GST_PAD_PROBE_OK;
    }
    GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
    if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION) {
      return GST_PAD_PROBE_OK;
    }
    gst_query_add_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr);
    return GST_PAD_PROBE_HANDLED;
  }
};

TEST(PipelineTest, PicturesAreHandedOverWithoutACopyAndReleased) {
  ASSERT_TRUE(init_gstreamer());
  PlaneAddresses addresses;
  SinkPipeline target;
  target.pipeline = *parse_pipeline(
      fmt::format("appsrc name={} ! videoconvert ! fakesink name=end", kFrameSourceName));
  const GstPadPtr pad(
      gst_element_get_static_pad(element_named(target.pipeline, "end").get(), "sink"));
  gst_pad_add_probe(
      pad.get(),
      static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM),
      PlaneAddresses::on_item, &addresses, nullptr);
  auto sink = GstreamerSink::start(std::move(target), {{36, 20}, 30, {}});
  ASSERT_TRUE(sink) << sink.error().message;
  std::vector<const void*> written;
  std::vector<std::weak_ptr<const void>> storages;
  for (const FrameStamp& stamp : irregular_stamps(8)) {
    const VideoFrame frame = test_picture({36, 20}, stamp);
    written.push_back(frame.planes[0].data);
    storages.push_back(frame.storage);
    ASSERT_TRUE((*sink)->write(frame));
  }
  ASSERT_TRUE((*sink)->finish());
  EXPECT_EQ(addresses.seen, written);
  sink->reset();
  for (const auto& storage : storages) {
    EXPECT_TRUE(storage.expired());
  }
}

TEST(PipelineTest, StampsMustRise) {
  auto sink = open_sink("identity ! fakesink", {kSize, 30, {}}, std::nullopt);
  ASSERT_TRUE(sink);
  const auto stamps = irregular_stamps(2);
  ASSERT_TRUE((*sink)->write(test_picture(kSize, stamps[1])));
  const auto written = (*sink)->write(test_picture(kSize, stamps[0]));
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("does not rise"));
}

TEST(VideoFileTest, OddSizesLoseTheirLastColumnAndRow) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "out.mp4";
  constexpr ImageSize kOdd{641, 361};
  auto sink = open_sink(path, {kOdd, 30, {}}, std::nullopt);
  ASSERT_TRUE(sink) << sink.error().message;
  ASSERT_EQ((*sink)->warnings().size(), 1U);
  EXPECT_THAT((*sink)->warnings()[0], HasSubstr("640x360"));
  ASSERT_TRUE((*sink)->write(test_picture(kOdd, irregular_stamps(1)[0])));
  ASSERT_TRUE((*sink)->finish());
  const auto playback = play_file(path);
  ASSERT_EQ(playback.buffers.size(), 1U);
  EXPECT_THAT(playback.caps, HasSubstr("width=(int)640, height=(int)360"));
}

/// With the numbers of ISO/IEC 23091-2 that an .mp4's colr box should hold.
struct Colorimetry {
  const char* name;
  const char* text;
  int matrix;
  int full_range_flag;
};

void PrintTo(const Colorimetry& color, std::ostream* out) {
  *out << color.text;
}

class ColorTest : public ::testing::TestWithParam<Colorimetry> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(ColorTest, IsCarriedIntoMatroska) {
  const auto path = folder_.path() / "out.mkv";
  for (const auto siting : {ChromaSiting::left, ChromaSiting::center}) {
    ASSERT_TRUE(write_pictures(path, {kSize, 30, {GetParam().text, siting}}, irregular_stamps(3)));
    // Decoders of GStreamer 1.26 leave the siting out, the parser of 1.22 does.
    const std::string coded = test::play("filesrc location=" + path.string() +
                                         " ! matroskademux ! h264parse ! appsink name=out")
                                  .caps;
    const std::string decoded = play_file(path).caps;
    const auto color = HasSubstr(fmt::format("colorimetry=(string){}", GetParam().text));
    EXPECT_THAT(coded, color);
    EXPECT_THAT(decoded, color);
    const auto sited = HasSubstr(siting == ChromaSiting::left ? "chroma-site=(string)mpeg2"
                                                              : "chroma-site=(string)jpeg");
    EXPECT_THAT(coded + decoded, sited);
  }
}

TEST_P(ColorTest, IsCarriedIntoMp4) {
  const auto path = folder_.path() / "out.mp4";
  const SinkFormat format{kSize, 30, {GetParam().text, ChromaSiting::left}};
  ASSERT_TRUE(write_pictures(path, format, irregular_stamps(3)));
  const std::string bytes = bytes_of(path);
  const auto box = bytes.find("colrnclx");
  ASSERT_NE(box, std::string::npos);
  EXPECT_EQ(bytes[box + 13], GetParam().matrix);
  EXPECT_EQ(static_cast<unsigned char>(bytes[box + 14]) >> 7, GetParam().full_range_flag);
}

INSTANTIATE_TEST_SUITE_P(Colorimetries, ColorTest,
                         ::testing::Values(Colorimetry{"Bt601", "bt601", 6, 0},
                                           Colorimetry{"Bt709", "bt709", 1, 0},
                                           Colorimetry{"Bt2020", "bt2020", 9, 0},
                                           Colorimetry{"Jfif", "1:4:7:1", 6, 1}),
                         [](const auto& color) -> std::string { return color.param.name; });

TEST(MissingElementTest, NamesThePackage) {
  ASSERT_TRUE(init_gstreamer());
  const test::TemporaryFolder folder;
  const WithoutElement no_muxer("mp4mux");
  const auto mp4 = open_sink(folder.path() / "out.mp4", {kSize, 30, {}}, std::nullopt);
  ASSERT_FALSE(mp4);
  EXPECT_EQ(mp4.error().kind, Error::Kind::bad_input);
  EXPECT_THAT(mp4.error().message, HasSubstr("apt install gstreamer1.0-plugins-good"));

  const WithoutElement no_x264("x264enc");
  const WithoutElement no_openh264("openh264enc");
  const WithoutElement no_v4l2("v4l2h264enc");
  const auto mkv = open_sink(folder.path() / "out.mkv", {kSize, 30, {}}, std::nullopt);
  ASSERT_FALSE(mkv);
  EXPECT_THAT(mkv.error().message, HasSubstr("apt install gstreamer1.0-plugins-ugly"));
}

TEST(EncoderTest, AnotherIsTakenWhereX264IsMissing) {
  ASSERT_TRUE(init_gstreamer());
  if (!is_element_installed("openh264enc") || !is_element_installed("h264parse")) {
    GTEST_SKIP() << "openh264enc or h264parse is not installed: gstreamer1.0-plugins-bad";
  }
  const test::TemporaryFolder folder;
  const WithoutElement no_x264("x264enc");
  for (const char* name : {"out.mp4", "out.mkv"}) {
    const auto path = folder.path() / name;
    const auto stamps = irregular_stamps(20);
    const auto written = write_pictures(path, {{320, 240}, 30, {}}, stamps);
    ASSERT_TRUE(written) << written.error().message;
    const auto playback = play_file(path);
    ASSERT_EQ(playback.buffers.size(), stamps.size());
    const auto last = (stamps.back().time - stamps.front().time).count();
    EXPECT_LE(std::abs(playback.buffers.back().running_time_ns - last), 100'000);
  }
}

TEST(VideoFileTest, RecordingIsNotOverwritten) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "video.mkv";
  ASSERT_TRUE(write_pictures(path, {kSize, 30, {}}, irregular_stamps(3)));
  const std::string before = bytes_of(path);
  const auto sink = open_sink(path, {kSize, 30, {}}, AudioTrack{path, {}});
  ASSERT_FALSE(sink);
  EXPECT_EQ(sink.error().kind, Error::Kind::bad_input);
  EXPECT_EQ(bytes_of(path), before);
}

}  // namespace
}  // namespace gimbal

#include "drivers/replay/still.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/gst_playback.hpp"
#include "tests/support/temporary_folder.hpp"

namespace gimbal {
namespace {

using ::testing::HasSubstr;

/// One colour all over, given as video levels of BT.709.
VideoFrame plain_picture(ImageSize size, std::uint8_t y, std::uint8_t u, std::uint8_t v) {
  Nv12Buffer buffer(size);
  const ImageSize chroma = chroma_size(size);
  for (int row = 0; row < size.height; ++row) {
    std::fill_n(buffer.luma().data + row * buffer.luma().stride_bytes, size.width, y);
  }
  for (int row = 0; row < chroma.height; ++row) {
    for (int column = 0; column < chroma.width; ++column) {
      std::uint8_t* pair = buffer.chroma().data + row * buffer.chroma().stride_bytes + 2 * column;
      pair[0] = u;
      pair[1] = v;
    }
  }
  return std::move(buffer).publish({}, {"bt709", ChromaSiting::left});
}

class StillTest : public ::testing::TestWithParam<const char*> {
 protected:
  test::TemporaryFolder folder_;
};

TEST_P(StillTest, KeepsTheColoursAndProportions) {
  const auto path = folder_.path() / (std::string("still") + GetParam());
  // Y = 100, U = 100, V = 200 is, by BT.709 in video range (ITU-R BT.709-6, items 3 and 4):
  const double luma = 255.0 / 219 * (100 - 16);
  const double red = luma + 255.0 / 224 * 1.5748 * (200 - 128);
  const double blue = luma + 255.0 / 224 * 1.8556 * (100 - 128);
  const double green = (luma - 0.2126 * red - 0.0722 * blue) / 0.7152;

  const auto written = write_still(plain_picture({321, 181}, 100, 100, 200), path, 160);
  ASSERT_TRUE(written) << written.error().message;

  const auto playback = test::play(fmt::format(
      "filesrc location={} ! decodebin ! videoconvert ! video/x-raw,format=RGB ! appsink name=out",
      path.string()));
  ASSERT_EQ(playback.buffers.size(), 1U);
  EXPECT_THAT(playback.caps, HasSubstr("width=(int)160, height=(int)90"));
  const auto& bytes = playback.buffers[0].bytes;
  ASSERT_EQ(bytes.size(), 160U * 90 * 3);
  // The wrong matrix would be 14 levels off in red; 8-bit conversions here and there cost some.
  EXPECT_NEAR(bytes[3 * 8000], red, 6);
  EXPECT_NEAR(bytes[3 * 8000 + 1], green, 6);
  EXPECT_NEAR(bytes[3 * 8000 + 2], blue, 6);
}

INSTANTIATE_TEST_SUITE_P(Formats, StillTest, ::testing::Values(".jpg", ".png"),
                         [](const auto& format) { return std::string(format.param).substr(1); });

TEST(StillErrorsTest, SayWhatIsWrong) {
  const test::TemporaryFolder folder;
  const VideoFrame picture = plain_picture({64, 48}, 100, 128, 128);
  const auto unknown = write_still(picture, folder.path() / "still.tiff");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr(".jpg or .png"));
  const auto unwritable = write_still(picture, folder.path() / "missing" / "still.png");
  ASSERT_FALSE(unwritable);
  EXPECT_THAT(unwritable.error().message, HasSubstr("No such file or directory"));
}

}  // namespace
}  // namespace gimbal

#include "daemon/no_signal.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace gimbal {
namespace {

TEST(NoSignal, HasWhiteWordsInTheMiddleOfGrey) {
  const VideoFrame picture = no_signal_picture({640, 360}, {});
  ASSERT_EQ(picture.size, (ImageSize{640, 360}));
  int white = 0;
  for (int y = 0; y < picture.size.height; ++y) {
    const std::uint8_t* row = picture.planes[0].data + y * picture.planes[0].stride_bytes;
    const auto in_row = std::count_if(row, row + picture.size.width, [](int v) { return v > 200; });
    if (y < 120 || y >= 240) {
      EXPECT_EQ(in_row, 0) << "row " << y;
    }
    white += static_cast<int>(in_row);
  }
  EXPECT_GT(white, 640 * 360 / 100);
  EXPECT_LT(white, 640 * 360 / 5);
}

TEST(NoSignal, FitsAnySize) {
  for (const ImageSize size : {ImageSize{1, 1}, ImageSize{33, 17}, ImageSize{400, 2}}) {
    EXPECT_EQ(no_signal_picture(size, {}).size, size);
  }
}

}  // namespace
}  // namespace gimbal

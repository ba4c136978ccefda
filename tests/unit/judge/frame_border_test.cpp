#include "tests/judge/frame_border.hpp"

#include <gtest/gtest.h>

#include "tests/unit/judge/moving_picture.hpp"

namespace gimbal::judge {
namespace {

TEST(BlackBorder, IsWhatIsBlackUpToTheEdge) {
  cv::Mat luma = seen(texture(), {0, 0, 0});
  luma.colRange(0, 20).setTo(16);
  luma.rowRange(260, 270).setTo(17);
  luma(cv::Rect(100, 100, 30, 30)).setTo(16);  // a window at night
  const cv::Mat border = black_border(luma);
  EXPECT_EQ(cv::countNonZero(border), 20 * 270 + 10 * (480 - 20));
  EXPECT_EQ(border.at<unsigned char>(110, 110), 0);
}

TEST(BlackBorder, IsNoneWhereThePictureIsDarkButNotBlack) {
  EXPECT_EQ(cv::countNonZero(black_border(cv::Mat(kSize, CV_8UC1, cv::Scalar(25)))), 0);
}

TEST(BlackBorder, IsAllOfABlackFrame) {
  EXPECT_EQ(cv::countNonZero(black_border(cv::Mat(kSize, CV_8UC1, cv::Scalar(16)))), kSize.area());
}

}  // namespace
}  // namespace gimbal::judge

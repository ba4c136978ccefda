#include "tests/judge/shown_view.hpp"

#include <gtest/gtest.h>

#include "tests/unit/judge/moving_picture.hpp"

namespace gimbal::judge {
namespace {

const double kMiddleX = (kSize.width - 1) / 2.0;
const double kMiddleY = (kSize.height - 1) / 2.0;

/// A linear map about the pictures' middles that looks aside by `shift_px`.
cv::Matx33d about_the_middle(const cv::Matx22d& A, const cv::Vec2d& shift_px) {
  const cv::Vec2d middle(kMiddleX, kMiddleY);
  const cv::Vec2d t = middle + shift_px - A * middle;
  return {A(0, 0), A(0, 1), t[0], A(1, 0), A(1, 1), t[1], 0, 0, 1};
}

cv::Mat shown(const cv::Mat& original, const cv::Matx33d& H_original_output) {
  cv::Mat output;
  cv::warpPerspective(original, output, H_original_output, kSize,
                      cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT, 16);
  return output;
}

ShownView compared(const cv::Matx33d& H_original_output) {
  const cv::Mat original = seen(texture(), {0, 0, 0});
  const auto view = compare_views(original, looked_at(shown(original, H_original_output)));
  return view.value_or(ShownView{{}, 0, 0, -1});
}

TEST(ShownView, KnowsTheZoom) {
  const ShownView view = compared(about_the_middle(cv::Matx22d::eye() * 0.8, {12, -7}));
  EXPECT_NEAR(view.zoom, 1.25, 0.002);
  EXPECT_NEAR(view.retained, 0.64, 0.002);
  EXPECT_LT(view.distortion, 0.002);
}

TEST(ShownView, SeesThroughARoll) {
  const double cosine = 0.87 * std::cos(0.1);
  const double sine = 0.87 * std::sin(0.1);
  const ShownView view = compared(about_the_middle({cosine, -sine, sine, cosine}, {20, 10}));
  EXPECT_NEAR(view.zoom, 1 / 0.87, 0.002);
  EXPECT_LT(view.distortion, 0.002);
}

TEST(ShownView, DoesNotRetainWhatLiesPastTheOriginal) {
  const ShownView view = compared(about_the_middle(cv::Matx22d::eye(), {48, 0}));
  EXPECT_NEAR(view.zoom, 1, 0.002);
  EXPECT_NEAR(view.retained, 0.9, 0.002);
}

TEST(ShownView, TellsStretchingFromZoom) {
  const ShownView view = compared(about_the_middle({0.8, 0, 0, 0.84}, {0, 0}));
  EXPECT_NEAR(view.distortion, 1 - 0.8 / 0.84, 0.002);
  EXPECT_NEAR(view.zoom, 1 / std::sqrt(0.8 * 0.84), 0.002);
}

TEST(ShownView, IsNotFoundInAnotherPicture) {
  const cv::Mat original = seen(texture(), {0, 0, 0});
  const cv::Mat other = texture()(cv::Rect({0, 0}, kSize)).clone();
  EXPECT_FALSE(compare_views(original, looked_at(other)));
}

}  // namespace
}  // namespace gimbal::judge

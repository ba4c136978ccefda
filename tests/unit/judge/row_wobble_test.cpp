#include "tests/judge/row_wobble.hpp"

#include <gtest/gtest.h>

#include "tests/unit/judge/moving_picture.hpp"

namespace gimbal::judge {
namespace {

constexpr int kFrames = 90;
constexpr double kHz = 5;

double bend_of(double y) {
  return std::cos(4 * std::numbers::pi * (y + 0.5) / kSize.height);
}

/// Every row of the frame moved sidewise by as much as it bends.
cv::Mat bent(const cv::Mat& frame, double amplitude_px) {
  cv::Mat x(kSize, CV_32F);
  cv::Mat y(kSize, CV_32F);
  for (int row = 0; row < kSize.height; ++row) {
    for (int column = 0; column < kSize.width; ++column) {
      x.at<float>(row, column) = static_cast<float>(column - amplitude_px * bend_of(row));
      y.at<float>(row, column) = static_cast<float>(row);
    }
  }
  cv::Mat moved;
  cv::remap(frame, moved, x, y, cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return moved;
}

template <typename Frame>
double wobble_px(Frame frame_at) {
  RowWobble wobble;
  TrackedPicture last = looked_at(frame_at(0.0));
  for (int i = 1; i < kFrames; ++i) {
    const TrackedPicture next = looked_at(frame_at(i / kFps));
    const std::vector<Track> tracks = track_corners(last, next);
    const auto R_to_from = fit_rotation(kCamera, tracks);
    if (!R_to_from) return -1;
    wobble.add((i - 0.5) / kFps, kCamera, *R_to_from, tracks);
    last = next;
  }
  return wobble.rms_px(1.0);
}

TEST(RowWobble, IsAsLargeAsRowsMove) {
  constexpr double kAmplitude_px = 1.2;
  const cv::Mat still = seen(texture(), {0, 0, 0});
  double squares = 0;  // of what a band's rows do on average
  for (std::size_t band = 0; band < RowWobble::kBands; ++band) {
    double sum = 0;
    constexpr int kRows = 100;
    for (int i = 0; i < kRows; ++i) {
      const double share = (static_cast<double>(band) + (i + 0.5) / kRows) / RowWobble::kBands;
      sum += bend_of(share * kSize.height - 0.5) / kRows;
    }
    squares += sum * sum / RowWobble::kBands;
  }
  const double expected_px = kAmplitude_px * std::sqrt(squares) * rms_step(kHz);
  const double found_px =
      wobble_px([&](double time_s) { return bent(still, kAmplitude_px * sine(kHz, time_s)); });
  EXPECT_NEAR(found_px, expected_px, 0.05 * expected_px);
}

TEST(RowWobble, IsNoneWhereTheCameraOnlyTurns) {
  const cv::Mat wall = texture();
  const double found_px = wobble_px([&](double time_s) {
    return seen(wall, {0.01 * sine(kHz, time_s), 0.02 * sine(3, time_s), 0.02 * sine(4, time_s)});
  });
  EXPECT_GE(found_px, 0);
  EXPECT_LT(found_px, 0.03);
}

}  // namespace
}  // namespace gimbal::judge

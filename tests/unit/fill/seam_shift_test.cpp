#include "pipeline/fill/seam_shift.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gimbal {
namespace {

constexpr ImageSize kSize{320, 160};

/// A soft pattern, moved; light from 40 to 200.
VideoFrame pattern(const Eigen::Vector2d& moved_px, double across) {
  Nv12Buffer buffer(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const Eigen::Vector2d at = Eigen::Vector2d(x, y) - moved_px;
      const double light = std::sin(at.x() / 11 + 2) + across * std::sin(at.y() / 9 + at.x() / 40);
      buffer.luma().data[y * buffer.luma().stride_bytes + x] =
          static_cast<std::uint8_t>(120 + 38 * light);
    }
  }
  std::fill_n(buffer.chroma().data, buffer.chroma().stride_bytes * kSize.height / 2, 128);
  return std::move(buffer).publish({}, {});
}

std::vector<CellPair> pairs_of(const VideoFrame& wanted, const VideoFrame& given) {
  const CellGrid grid(kSize);
  std::vector<CellPair> pairs;
  grid.for_each_cell([&](CellPlace cell) {
    pairs.push_back({look_at(wanted.planes, grid, cell), look_at(given.planes, grid, cell)});
  });
  return pairs;
}

TEST(SeamShift, FindsWhatAPictureWasMovedBy) {
  const VideoFrame still = pattern({0, 0}, 1);
  for (const Eigen::Vector2d& moved_px : {Eigen::Vector2d(0.5, -0.3), Eigen::Vector2d(-2, 1)}) {
    const auto shift = seam_shift_px(pairs_of(still, pattern(moved_px, 1)), {});
    EXPECT_NEAR(shift.x(), -moved_px.x(), 0.1 + 0.15 * std::abs(moved_px.x()));
    EXPECT_NEAR(shift.y(), -moved_px.y(), 0.1 + 0.15 * std::abs(moved_px.y()));
  }
}

TEST(SeamShift, SaysNothingAlongAnEdge) {
  const auto shift = seam_shift_px(pairs_of(pattern({0, 0}, 0), pattern({1, 1}, 0)), {});
  EXPECT_NEAR(shift.x(), -1, 0.2);
  EXPECT_EQ(shift.y(), 0);
}

TEST(SeamDrift, LearnsARateAndForgetsIt) {
  SeamDrift drift;
  EXPECT_EQ(drift.expected_px(0.5).norm(), 0);
  for (int i = 0; i < 10; ++i) drift.learn(i % 2 == 0 ? 0.3 : -0.2, {i % 2 == 0 ? 3.F : -2.F, 0});
  EXPECT_NEAR(drift.expected_px(0.5).x(), 5, 0.1);
  EXPECT_NEAR(drift.expected_px(-0.1).x(), -1, 0.02);
  for (int i = 0; i < 200; ++i) drift.learn(0.3, {0, 0});
  EXPECT_NEAR(drift.expected_px(0.5).x(), 0, 0.1);
}

}  // namespace
}  // namespace gimbal

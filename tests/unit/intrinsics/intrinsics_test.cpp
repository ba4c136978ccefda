#include "pipeline/intrinsics/intrinsics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/rendered_board.hpp"

namespace gimbal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr ImageSize kSize = {640, 480};
constexpr double kNoise_px = 0.06;  // in each coordinate; about what the detector has
const CalibrationBoard kBoard{BoardKind::checkerboard, 9, 6, 0, ""};

Lens lens_of(LensModel model, double focal_px, std::vector<double> distortion) {
  LensParameters parameters;
  parameters.model = model;
  parameters.K << focal_px, 0, 325.3, 0, 1.006 * focal_px, 236.8, 0, 0, 1;
  parameters.distortion = std::move(distortion);
  return *Lens::create(parameters);
}

Lens pinhole() {
  return lens_of(LensModel::pinhole, 520, {});
}

Lens brown() {
  return lens_of(LensModel::brown, 520, {-0.28, 0.09, 0.0008, -0.0005, -0.01});
}

Lens fisheye() {
  return lens_of(LensModel::fisheye, 260, {-0.02, 0.004, -0.002, 0.0005});
}

std::vector<BoardView> views_by(const Lens& lens, std::uint64_t seed, int count = 20,
                                const test::BoardPoses& how = {}) {
  return test::noisy_views(kBoard, lens, test::board_poses(kBoard, lens, kSize, count, seed, how),
                           kNoise_px, seed);
}

/// fx, fy, cx, cy: how far off, over fx.
std::vector<double> errors_of(const LensFit& fit, const Lens& truth) {
  const Eigen::Matrix3d off = (fit.lens.K - truth.parameters().K) / truth.parameters().K(0, 0);
  return {off(0, 0), off(1, 1), off(0, 2), off(1, 2)};
}

class EveryModel : public ::testing::TestWithParam<int> {
 protected:
  const Lens lens_ =
      std::vector{pinhole(), brown(), fisheye()}.at(static_cast<std::size_t>(GetParam()));
};
INSTANTIATE_TEST_SUITE_P(Models, EveryModel, ::testing::Values(0, 1, 2));

TEST_P(EveryModel, IsFoundAndSaysHowWell) {
  constexpr int kSeeds = 6;
  int within_two_sigma = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const Intrinsics found =
        calibrate_intrinsics(views_by(lens_, seed), kSize, lens_.parameters().model);
    ASSERT_THAT(found.reason, IsEmpty());
    ASSERT_TRUE(found.fit);
    EXPECT_NEAR(found.fit->rms_px, std::sqrt(2) * kNoise_px, 0.1 * kNoise_px);
    const std::vector<double> errors = errors_of(*found.fit, lens_);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      EXPECT_LT(std::abs(errors[i]), 0.003) << "parameter " << i << ", seed " << seed;
      const double sigma = found.fit->sigmas[i] / lens_.parameters().K(0, 0);
      within_two_sigma += std::abs(errors[i]) < 2 * sigma ? 1 : 0;
    }
  }
  // 95 % of 24 are 23; fewer than 19 happen once in 300 times.
  EXPECT_GE(within_two_sigma, 19);
}

// What the lens does to the whole picture is what counts: coefficients may trade places.
TEST_P(EveryModel, BendsEveryPixelAsTheTruthDoes) {
  const Intrinsics found =
      calibrate_intrinsics(views_by(lens_, 7), kSize, lens_.parameters().model);
  ASSERT_TRUE(found.fit);
  const Lens fitted = *Lens::create(found.fit->lens);
  for (int i = 0; i < 35; ++i) {
    const Eigen::Vector2d pixel(50 + 90 * (i % 7), 40 + 100 * (i / 7));
    const auto there = fitted.project(*lens_.unproject(pixel));
    ASSERT_TRUE(there);
    EXPECT_LT((*there - pixel).norm(), 0.003 * 520) << pixel.transpose();
  }
}

TEST(Intrinsics, LeavesOutAndNamesWhatContradicts) {
  std::vector<BoardView> views = views_by(brown(), 3);
  for (const std::size_t wrong : {4U, 11U}) {
    for (Eigen::Vector2d& seen_px : views[wrong].seen_px) {
      seen_px.x() += 3 * std::sin(seen_px.y() / 20);
    }
  }
  const Intrinsics found = calibrate_intrinsics(views, kSize, LensModel::brown);
  EXPECT_THAT(found.reason, IsEmpty());
  ASSERT_EQ(found.left_out.size(), 2U);
  EXPECT_THAT((std::vector{found.left_out[0].name, found.left_out[1].name}),
              ::testing::UnorderedElementsAre("picture 5", "picture 12"));
  EXPECT_EQ(found.views.size(), 18U);
  EXPECT_LT(std::abs(errors_of(*found.fit, brown())[0]), 0.003);
}

TEST(Intrinsics, CannotTellFromFewViews) {
  EXPECT_THAT(calibrate_intrinsics(views_by(brown(), 3, 5), kSize, LensModel::brown).reason,
              HasSubstr("only 5 pictures"));
  EXPECT_THAT(calibrate_intrinsics({}, kSize, LensModel::brown).reason,
              HasSubstr("only 0 pictures"));
}

TEST_P(EveryModel, CannotBeToldWithoutTilts) {
  test::BoardPoses flat;
  flat.tilt_rad = 0;
  flat.facing = test::Facing::picture_plane;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Intrinsics found =
        calibrate_intrinsics(views_by(lens_, seed, 20, flat), kSize, lens_.parameters().model);
    EXPECT_THAT(found.reason, ::testing::Not(IsEmpty()));
  }
}

TEST(Intrinsics, CannotTellOfWhatOnlyTheMiddleShowed) {
  test::BoardPoses middle;
  middle.reach = 0.15;
  middle.share = 0.3;
  for (const Lens& lens : {brown(), fisheye()}) {
    EXPECT_THAT(
        calibrate_intrinsics(views_by(lens, 3, 20, middle), kSize, lens.parameters().model).reason,
        HasSubstr("cover only"));
  }
}

TEST(Intrinsics, CannotTellByTheWrongModel) {
  EXPECT_THAT(calibrate_intrinsics(views_by(fisheye(), 3), kSize, LensModel::brown).reason,
              HasSubstr("another model"));
  // So little leaves a third of a pixel, while the focal length is off by 6 %.
  const Lens little = lens_of(LensModel::brown, 520, {-0.1, 0, 0, 0});
  EXPECT_THAT(calibrate_intrinsics(views_by(little, 3), kSize, LensModel::pinhole).reason,
              HasSubstr("the lens distorts"));
}

TEST(Intrinsics, CannotTellByABentBoard) {
  const Lens lens = brown();
  std::vector<BoardView> views;
  for (const auto& pose : test::board_poses(kBoard, lens, kSize, 20, 5)) {
    views.emplace_back();
    for (int i = 0; i < 54; ++i) {
      const Eigen::Vector2d corner(i % 9, i / 9);
      const double bulge = 0.4 * std::sin(corner.x() * 0.39);
      views.back().corners.push_back(corner);
      views.back().seen_px.push_back(
          *lens.project(pose * Eigen::Vector3d(corner.x(), corner.y(), bulge)));
    }
  }
  EXPECT_THAT(calibrate_intrinsics(views, kSize, LensModel::brown).reason, HasSubstr("not flat"));
}

TEST(Intrinsics, CannotTellByTheSamePictureTwentyTimes) {
  const std::vector<BoardView> one = views_by(brown(), 3, 1);
  const std::vector<BoardView> views(20, one.front());
  EXPECT_THAT(calibrate_intrinsics(views, kSize, LensModel::brown).reason,
              ::testing::Not(IsEmpty()));
}

}  // namespace
}  // namespace gimbal

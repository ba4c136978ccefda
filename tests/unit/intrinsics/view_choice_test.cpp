#include "pipeline/intrinsics/view_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "pipeline/intrinsics/coverage.hpp"
#include "tests/support/rendered_board.hpp"

namespace gimbal {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr ImageSize kSize = {640, 480};
const CalibrationBoard kBoard{BoardKind::checkerboard, 9, 6, 0, ""};

Lens pinhole() {
  LensParameters parameters;
  parameters.K << 500, 0, 319.5, 0, 500, 239.5, 0, 0, 1;
  return *Lens::create(parameters);
}

/// The board's middle on the axis, turned about an axis of the camera.
BoardView turned(const Eigen::Vector3d& axis, double angle_rad) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0, 0, 15) - pose.linear() * Eigen::Vector3d(4, 2.5, 0);
  return test::noisy_views(kBoard, pinhole(), {pose}, 0, 1).front();
}

std::vector<BoardView> views_of(int count) {
  return test::noisy_views(kBoard, pinhole(), test::board_poses(kBoard, pinhole(), kSize, count, 3),
                           0.05, 3);
}

// Turned about y (down) by a, what was at x is nearer by x sin a; about x what was at y is farther
// by y sin a.
TEST(Coverage, TellsWhichSideIsNearer) {
  EXPECT_LT(shape_of(turned(Eigen::Vector3d::UnitY(), -0.5), kSize).tilt.x(), -0.3);
  EXPECT_GT(shape_of(turned(Eigen::Vector3d::UnitY(), 0.5), kSize).tilt.x(), 0.3);
  EXPECT_LT(shape_of(turned(Eigen::Vector3d::UnitX(), 0.5), kSize).tilt.y(), -0.3);
  EXPECT_NEAR(shape_of(turned(Eigen::Vector3d::UnitX(), 0), kSize).tilt.norm(), 0, 1e-6);
}

TEST(Coverage, SaysWhatIsMissing) {
  const std::vector<BoardView> one = {turned(Eigen::Vector3d::UnitY(), -0.5)};
  const auto missing = coverage_of(one, kSize).missing();
  EXPECT_THAT(missing, Contains("the picture's top left"));
  EXPECT_THAT(missing, Not(Contains("the picture's middle")));
  EXPECT_THAT(missing, Contains(HasSubstr("right side")));
  EXPECT_THAT(missing, Not(Contains(HasSubstr("left side"))));
  EXPECT_THAT(coverage_of(views_of(60), kSize).missing(), IsEmpty());
  EXPECT_EQ(coverage_of({}, kSize).share(), 0);
}

TEST(ViewChoice, TakesTheSharperOfTwoThatAreAlike) {
  ViewChoice choice(kSize, ViewChoice::Pictures::running);
  BoardView view = views_of(1).front();
  view.sharpness = 0.3;
  view.name = "first";
  EXPECT_TRUE(choice.offer(view));
  view.sharpness = 0.2;
  EXPECT_FALSE(choice.offer(view));
  view.sharpness = 0.4;
  view.name = "sharper";
  EXPECT_TRUE(choice.offer(view));
  ASSERT_EQ(choice.views().size(), 1U);
  EXPECT_EQ(choice.views().front().name, "sharper");
}

TEST(ViewChoice, KeepsAllThatSomebodyChose) {
  ViewChoice choice(kSize, ViewChoice::Pictures::chosen);
  const BoardView view = views_of(1).front();
  EXPECT_TRUE(choice.offer(view));
  EXPECT_TRUE(choice.offer(view));
  EXPECT_EQ(choice.views().size(), 2U);
}

// However long the video: some dozens, which cover as much as all of them.
TEST(ViewChoice, HoldsFewAndCoversAll) {
  const std::vector<BoardView> views = views_of(1000);
  ViewChoice choice(kSize, ViewChoice::Pictures::running);
  for (const BoardView& view : views) choice.offer(view);
  EXPECT_LE(choice.views().size(), 40U);
  EXPECT_GE(choice.views().size(), 20U);
  EXPECT_GE(coverage_of(choice.views(), kSize).share(), coverage_of(views, kSize).share() - 0.05);
  EXPECT_THAT(coverage_of(choice.views(), kSize).missing(), IsEmpty());
}

}  // namespace
}  // namespace gimbal

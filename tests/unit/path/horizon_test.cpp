#include "pipeline/path/horizon.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gimbal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

/// Looks north, or `pitch` above it, and rolls clockwise.
Quaterniond camera(double pitch_deg, double roll_deg) {
  Eigen::Matrix3d level;  // columns: right is east, down, forward is north
  level << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return Quaterniond(level) * AngleAxisd(pitch_deg * kDegree, Vector3d::UnitX()) *
         AngleAxisd(roll_deg * kDegree, Vector3d::UnitZ());
}

TEST(Horizon, RollIsWhatTheCameraTurnsClockwise) {
  // Its right edge goes down: x points below the horizon.
  EXPECT_LT((camera(0, 20) * Vector3d::UnitX()).z(), 0);
  for (const double pitch : {-60, 0, 30}) {
    for (const double roll : {-170, -30, 0, 45, 120}) {
      EXPECT_NEAR(roll_rad(camera(pitch, roll)), roll * kDegree, 1e-9);
    }
  }
}

TEST(Horizon, ALevelledCameraLooksTheSameWayWithItsHorizonLevel) {
  for (const double pitch : {-60, 0, 30}) {
    const Quaterniond level = levelled(camera(pitch, 30), 45 * kDegree);
    EXPECT_NEAR((level * Vector3d::UnitX()).z(), 0, 1e-9);
    EXPECT_LT((level * Vector3d::UnitY()).z(), 0);  // not upside down
    EXPECT_LT((level * Vector3d::UnitZ() - camera(pitch, 0) * Vector3d::UnitZ()).norm(), 1e-9);
  }
}

TEST(Horizon, MoreRollThanTheLockAllowsIsLeft) {
  // 45 degrees are taken out of 45, none of 180; in between ever less.
  EXPECT_NEAR(roll_rad(levelled(camera(0, 90), 45 * kDegree)), 60 * kDegree, 1e-9);
  EXPECT_NEAR(roll_rad(levelled(camera(0, -112.5), 45 * kDegree)), -90 * kDegree, 1e-9);
}

TEST(Horizon, RollingRightRoundNothingJumps) {
  Quaterniond before = levelled(camera(10, -200), 45 * kDegree);
  for (double roll = -200; roll < 200; roll += 0.1) {
    const Quaterniond now = levelled(camera(10, roll), 45 * kDegree);
    EXPECT_LT(now.angularDistance(before), 0.2 * kDegree) << roll;
    before = now;
  }
}

TEST(Horizon, RollPerTurnIsItsDerivative) {
  for (const double pitch : {-50, 0, 40}) {
    for (const double roll : {-40, 0, 20}) {
      const Quaterniond q = camera(pitch, roll);
      for (int axis = 0; axis < 3; ++axis) {
        constexpr double kTurn_rad = 1e-6;
        const Quaterniond turned = AngleAxisd(kTurn_rad, Vector3d::Unit(axis)) * q;
        EXPECT_NEAR(roll_per_turn(q)[axis], (roll_rad(turned) - roll_rad(q)) / kTurn_rad, 1e-5);
      }
    }
  }
}

TEST(Horizon, StraightUpAndDownThereIsNone) {
  for (const double pitch : {-90, -86, 86, 90}) {
    const Quaterniond down = camera(pitch, 25);
    EXPECT_LT(down.angularDistance(levelled(down, 45 * kDegree)), 1e-6) << pitch;
  }
}

TEST(Horizon, PassingStraightDownNothingJumps) {
  Quaterniond before = levelled(camera(-60, 10), 45 * kDegree);
  for (double pitch = -60; pitch > -120; pitch -= 0.1) {
    const Quaterniond now = levelled(camera(pitch, 10), 45 * kDegree);
    EXPECT_LT(now.angularDistance(before), 0.6 * kDegree) << pitch;
    before = now;
  }
}

}  // namespace
}  // namespace gimbal

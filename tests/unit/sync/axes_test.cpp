#include "pipeline/sync/axes.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <set>

#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

/// All 48 orders of axes with signs.
std::vector<Eigen::Matrix3d> all_axes() {
  std::vector<Eigen::Matrix3d> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) {
        axes(row, order.at(static_cast<std::size_t>(row))) = (signs >> row) % 2 == 0 ? 1 : -1;
      }
      all.push_back(axes);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

TEST(Axes, AreRecognisedUpToATiltOfThirtyDegrees) {
  const Eigen::Matrix3d tilt = quaternion_exp(Eigen::Vector3d(0.3, -0.2, 0.35)).toRotationMatrix();
  for (const Eigen::Matrix3d& axes : all_axes()) EXPECT_EQ(nearest_axes(tilt * axes), axes);
}

TEST(Axes, HaveAFaultOfTheirOwnEach) {
  std::set<std::string> faults;
  for (const Eigen::Matrix3d& axes : all_axes()) faults.insert(axes_fault(axes));
  EXPECT_EQ(faults.size(), 48U);
}

TEST(Axes, AreNamed) {
  EXPECT_EQ(axes_fault(Eigen::Matrix3d::Identity()), "");
  Eigen::Matrix3d axes;
  axes << 1, 0, 0, 0, 0, 1, 0, 1, 0;
  EXPECT_EQ(axes_fault(axes), "y and z are swapped");
  EXPECT_EQ(axes_fault(Eigen::Vector3d(1, 1, -1).asDiagonal()), "z has the wrong sign");
  EXPECT_EQ(axes_fault(Eigen::Vector3d(-1, 1, -1).asDiagonal()), "x and z have the wrong sign");
  axes << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(axes_fault(axes), "x and y are swapped, and x has the wrong sign");
}

}  // namespace
}  // namespace gimbal

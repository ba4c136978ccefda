#include "pipeline/sample/upright.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kRounding = 1e-14;

TEST(TurnUpright, IsEigensShortestRotation) {
  std::mt19937 generator(1);
  std::normal_distribution<double> component(0, 5);
  for (int i = 0; i < 100; ++i) {
    const Vector3d direction(component(generator), component(generator), component(generator));
    const auto expected = Quaterniond::FromTwoVectors(direction, Vector3d::UnitZ());
    EXPECT_LT(turn_upright(direction).angularDistance(expected), 1e-7) << direction.transpose();
    EXPECT_LT((turn_upright(direction) * direction.normalized() - Vector3d::UnitZ()).norm(),
              kRounding);
  }
}

TEST(TurnUpright, LeavesWhatIsUpright) {
  EXPECT_EQ(turn_upright({0, 0, 9.81}).coeffs(), Quaterniond::Identity().coeffs());
}

TEST(TurnUpright, TurnsOverWhatIsStraightDownOrNearlySo) {
  for (const double aside : {0.0, 1e-300, 1e-12, 1e-6}) {
    const Vector3d down = Vector3d(0, aside, -1).normalized();
    const Quaterniond turn = turn_upright(down);
    EXPECT_LT((turn * down - Vector3d::UnitZ()).norm(), kRounding) << aside;
    EXPECT_NEAR(turn.angularDistance(Quaterniond::Identity()), std::numbers::pi, 2e-6) << aside;
  }
}

}  // namespace
}  // namespace gimbal

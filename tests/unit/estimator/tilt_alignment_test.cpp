#include "pipeline/estimator/tilt_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "pipeline/sample/attitude.hpp"

namespace gimbal {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kStep_s = 0.02;
constexpr double kNothingKnown_rad2_s2 = 0.05 * 0.05;

ErrorStateFilter::Pending step_of(const Eigen::Vector3d& force_m_s2) {
  ErrorStateFilter::Pending step;
  step.rotation_s = kStep_s * Eigen::Matrix3d::Identity();
  step.velocity_m_s = kStep_s * force_m_s2;
  step.interval_s = step.accel_interval_s = kStep_s;
  return step;
}

double angle_between(const Eigen::Quaterniond& turn, const Eigen::Vector3d& up) {
  return std::acos(std::min(1.0, (turn * up.normalized()).z()));
}

/// A device that is shaken, so that its velocity is a low-passed noise.
class Shaken {
 public:
  Shaken(const Eigen::Vector3d& up, double velocity_m_s, unsigned seed)
      : random_(seed), up_(up.normalized()), sigma_m_s_(velocity_m_s) {
    velocity_m_s_ = sigma_m_s_ * draw();
  }

  /// The mean over a step.
  Eigen::Vector3d next_force() {
    const double kept = std::exp(-kStep_s / 0.15);
    const Eigen::Vector3d next =
        kept * velocity_m_s_ + std::sqrt(1 - kept * kept) * sigma_m_s_ * draw();
    Eigen::Vector3d force = (next - velocity_m_s_) / kStep_s + kGravity_m_s2 * up_;
    velocity_m_s_ = next;
    return force;
  }

 private:
  Eigen::Vector3d draw() {
    const double x = normal_(random_);
    const double y = normal_(random_);
    return {x, y, normal_(random_)};
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d up_;
  double sigma_m_s_;
  Eigen::Vector3d velocity_m_s_;
};

TEST(TiltAlignment, AtRestIsUprightFromTheFirstForce) {
  const Eigen::Vector3d up(1, -2, -3);
  TiltAlignment alignment{{}};
  EXPECT_EQ(alignment.turn_upright({}).coeffs(), Eigen::Quaterniond::Identity().coeffs());
  alignment.start(9.81 * up.normalized());
  EXPECT_LT(angle_between(alignment.turn_upright({}), up), 1e-6);
  int steps = 0;
  for (; !alignment.is_done(1e-6); ++steps) alignment.add(step_of(9.81 * up.normalized()), 0);
  EXPECT_LT(steps * kStep_s, 1);
  EXPECT_LT(angle_between(alignment.turn_upright({}), up), 1e-6);
}

// Its error should be what it says, and after a second far less than that of a force.
TEST(TiltAlignment, SaysHowWrongItIsOnADeviceThatIsShaken) {
  double squared = 0;
  double variance = 0;
  double squared_of_force = 0;
  constexpr int kRuns = 400;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    const Eigen::Vector3d up(std::sin(seed), std::cos(seed), -0.5);
    Shaken device(up, 0.6, seed);
    TiltAlignment alignment{{}};
    const Eigen::Vector3d first = device.next_force();
    alignment.start(first);
    squared_of_force += std::pow(angle_between(alignment.turn_upright({}), up), 2);
    for (int i = 0; i < 50; ++i) alignment.add(step_of(device.next_force()), 0);
    squared += std::pow(angle_between(alignment.turn_upright({}), up), 2);
    variance += 2 * alignment.tilt_variance_rad2();
  }
  EXPECT_LT(squared, squared_of_force / 9);
  EXPECT_LT(squared, 1.5 * variance);
  EXPECT_GT(squared, variance / 9);  // an acceleration as white as this one is shaken harder
}

TEST(TiltAlignment, TheLongerTheSurer) {
  Shaken device({0, 0, 1}, 0.6, 7);
  TiltAlignment alignment{{}};
  double last = alignment.tilt_variance_rad2();
  EXPECT_DOUBLE_EQ(last, kUnknownAngle_rad2);
  alignment.start(device.next_force());
  for (int k = 0; k < 5; ++k) {
    for (int i = 0; i < 20; ++i) alignment.add(step_of(device.next_force()), 0);
    EXPECT_LT(alignment.tilt_variance_rad2(), last);
    last = alignment.tilt_variance_rad2();
  }
}

TEST(TiltAlignment, ABiasThatIsUnknownEndsIt) {
  TiltAlignment known{{}};
  TiltAlignment unknown{{}};
  Shaken device({0, 0, 1}, 0.6, 2);
  known.start(device.next_force());
  unknown.start(device.next_force());
  int until_known = 0;
  int until_unknown = 0;
  for (int i = 0; i < 400; ++i) {
    const auto step = step_of(device.next_force());
    if (!known.is_done(1e-8)) ++until_known;
    if (!unknown.is_done(25 * kNothingKnown_rad2_s2)) ++until_unknown;
    known.add(step, 0);
    unknown.add(step, 0);
  }
  EXPECT_LT(until_unknown, until_known);
  EXPECT_LE(until_known * kStep_s, TiltAlignmentParameters{}.longest_s + kStep_s);
}

TEST(TiltAlignment, FreeFallHasNoDirection) {
  TiltAlignment alignment{{}};
  alignment.start({0, 0.1, 0});
  for (int i = 0; i < 1000; ++i) alignment.add(step_of({0, 0.1, 0}), 0);
  EXPECT_FALSE(alignment.is_done(kNothingKnown_rad2_s2));
  EXPECT_EQ(alignment.turn_upright({}).coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

/// A camera that turns about a level axis as evenly as a bias would make it: half of the turn is
/// unseen at the end.
TEST(TiltAlignment, KnowsWhatABiasTurnsUnseen) {
  const double bias_rad_s = 3 * kDegree;
  TiltAlignment alignment{{}};
  for (int i = 0; i < 100; ++i) {
    const double turned = bias_rad_s * (i + 0.5) * kStep_s;
    alignment.add(step_of(9.81 * Eigen::Vector3d(0, std::sin(turned), std::cos(turned))), 0);
  }
  const double at_end = bias_rad_s * 100 * kStep_s;
  const Eigen::Vector3d up(0, std::sin(at_end), std::cos(at_end));
  const double expected = alignment.turn_by_gyro_bias_s()(0, 0) * bias_rad_s;
  EXPECT_NEAR(angle_between(alignment.turn_upright({}), up), expected, 0.01 * expected);
}

}  // namespace
}  // namespace gimbal

#include "drivers/synthetic/motion.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "drivers/synthetic/random.hpp"
#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

MotionKnots random_knots(int count, std::uint64_t seed) {
  Random random(seed);
  const auto vector = [&](double size) {
    const double x = random.normal();
    const double y = random.normal();
    return Eigen::Vector3d(size * x, size * y, size * random.normal());
  };
  MotionKnots knots;
  knots.first = SensorTime(milliseconds(-10));
  knots.spacing = milliseconds(10);
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (int i = 0; i < count; ++i) {
    q = (q * quaternion_exp(vector(0.03))).normalized();
    knots.q_world_camera.push_back(q);
    knots.acceleration_m_s2.push_back(vector(2.0));
  }
  return knots;
}

TEST(Motion, RateIsTheDerivativeOfTheOrientation) {
  const Motion motion(random_knots(30, 1));
  constexpr nanoseconds kStep(2000);
  for (SensorTime t = motion.begin() + kStep; t < motion.end() - kStep; t += nanoseconds(1700001)) {
    const Eigen::AngleAxisd turned(motion.at(t - kStep).q_world_camera.conjugate() *
                                   motion.at(t + kStep).q_world_camera);
    const Eigen::Vector3d difference = turned.angle() * turned.axis() / (2.0 * to_seconds(kStep));
    EXPECT_LT((motion.at(t).rate_rad_s - difference).norm(), 1e-4) << seconds_since_epoch(t);
  }
}

TEST(Motion, RateDerivativeIsTheDerivativeOfTheRate) {
  const Motion motion(random_knots(30, 2));
  constexpr nanoseconds kStep(2000);
  for (SensorTime t = motion.begin() + kStep; t < motion.end() - kStep; t += nanoseconds(1700001)) {
    const Eigen::Vector3d difference =
        (motion.at(t + kStep).rate_rad_s - motion.at(t - kStep).rate_rad_s) /
        (2.0 * to_seconds(kStep));
    // Its own derivative is about 1e5 rad/s³ here and jumps at knots.
    EXPECT_LT((motion.at(t).rate_derivative_rad_s2 - difference).norm(), 1.0);
  }
}

TEST(Motion, IsSmoothAcrossKnots) {
  const Motion motion(random_knots(30, 3));
  for (int k = 1; k < 27; ++k) {
    const SensorTime knot = motion.begin() + k * milliseconds(10);
    const MotionState before = motion.at(knot - nanoseconds(1));
    const MotionState after = motion.at(knot);
    EXPECT_LT(before.q_world_camera.angularDistance(after.q_world_camera), 1e-7);
    EXPECT_LT((before.rate_rad_s - after.rate_rad_s).norm(), 1e-5);
    EXPECT_LT((before.rate_derivative_rad_s2 - after.rate_derivative_rad_s2).norm(), 1e-2);
    EXPECT_LT((before.acceleration_m_s2 - after.acceleration_m_s2).norm(), 1e-5);
  }
}

TEST(Motion, KeepsAConstantRateExactly) {
  const Eigen::Vector3d rate(0.3, -1.1, 2.0);
  const Eigen::Quaterniond q_start(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  MotionKnots knots;
  knots.first = SensorTime(milliseconds(-10));
  knots.spacing = milliseconds(10);
  for (int i = -1; i < 50; ++i) {
    knots.q_world_camera.push_back(q_start *
                                   Eigen::AngleAxisd(rate.norm() * 0.01 * i, rate.normalized()));
    knots.acceleration_m_s2.emplace_back(0, 0, 0);
  }
  const Motion motion(knots);
  for (const double t : {0.0, 0.0123, 0.1, 0.31415, 0.47}) {
    const MotionState state = motion.at(time_from_seconds(t));
    const Eigen::Quaterniond expected =
        q_start * Eigen::AngleAxisd(rate.norm() * t, rate.normalized());
    EXPECT_LT(state.q_world_camera.angularDistance(expected), 1e-8);
    EXPECT_LT((state.rate_rad_s - rate).norm(), 1e-9);
    EXPECT_LT(state.rate_derivative_rad_s2.norm(), 1e-6);
  }
}

TEST(Motion, StandsStillOutsideOfItsTime) {
  const Motion motion(random_knots(10, 4));
  const MotionState after = motion.at(motion.end() + milliseconds(500));
  EXPECT_EQ(after.rate_rad_s.norm(), 0.0);
  EXPECT_EQ(after.acceleration_m_s2.norm(), 0.0);
  EXPECT_LT(after.q_world_camera.angularDistance(motion.at(motion.end()).q_world_camera), 1e-9);
  EXPECT_EQ(motion.at(motion.begin() - milliseconds(500)).rate_rad_s.norm(), 0.0);
}

TEST(Rotation, LogUndoesExp) {
  for (const double angle : {0.0, 1e-12, 1e-6, 1e-4, 0.1, 1.0, 3.0}) {
    const Eigen::Vector3d vector = angle * Eigen::Vector3d(2, -1, 0.5).normalized();
    EXPECT_LT((quaternion_log(quaternion_exp(vector)) - vector).norm(), 1e-12) << angle;
    const Eigen::Quaterniond expected(
        Eigen::AngleAxisd(angle, Eigen::Vector3d(2, -1, 0.5).normalized()));
    EXPECT_LT((quaternion_exp(vector).coeffs() - expected.coeffs()).norm(), 1e-12) << angle;
  }
}

}  // namespace
}  // namespace gimbal

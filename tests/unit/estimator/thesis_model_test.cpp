#include "pipeline/estimator/thesis_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <random>

namespace gimbal {
namespace {

using std::chrono::milliseconds;

class ThesisModel : public testing::Test {
 protected:
  QuaternionVector random_quaternion() {
    QuaternionVector q;
    for (auto& component : q) component = normal_(random_);
    return q.normalized();
  }

  Eigen::Vector3d random_rate(double scale_rad_s) {
    return scale_rad_s * Eigen::Vector3d(normal_(random_), normal_(random_), normal_(random_));
  }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

Eigen::Quaterniond to_quaternion(const QuaternionVector& q) {
  return {q(0), q(1), q(2), q(3)};
}

QuaternionVector product(const QuaternionVector& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond c = to_quaternion(a) * b;
  return {c.w(), c.x(), c.y(), c.z()};
}

/// By its power series.
Eigen::Matrix4d matrix_exponential(const Eigen::Matrix4d& A) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity();
  for (int n = 1; n < 40; ++n) {
    term = term * A / n;
    sum += term;
  }
  return sum;
}

TEST_F(ThesisModel, BothFormsOfTheDerivativeAreTheHamiltonProductWithTheRate) {
  for (int i = 0; i < 20; ++i) {
    const auto q = random_quaternion();
    const auto rate = random_rate(2);
    const auto expected = product(q, Eigen::Quaterniond(0, rate.x(), rate.y(), rate.z()));
    EXPECT_LT((rate_matrix(rate) * q - expected).norm(), 1e-14);
    EXPECT_LT((quaternion_matrix(q) * rate - expected).norm(), 1e-14);
  }
}

TEST_F(ThesisModel, ExactTransitionIsTheMatrixExponential) {
  for (double scale : {0.0, 1e-9, 1e-3, 1.0, 30.0}) {
    for (int i = 0; i < 10; ++i) {
      const auto q = random_quaternion();
      const auto rate = random_rate(scale);
      const auto F = discretize(Discretization::exact, rate, milliseconds(20), q).F;
      EXPECT_LT((F - matrix_exponential(0.5 * 0.020 * rate_matrix(rate))).norm(), 1e-14);
    }
  }
}

TEST_F(ThesisModel, SmallAngleTransitionIsTheFirstOrderOfTheExponential) {
  const auto q = random_quaternion();
  const auto rate = random_rate(2);
  double last_error = 0;
  for (int ms : {80, 40, 20, 10}) {
    const auto F = discretize(Discretization::small_angle, rate, milliseconds(ms), q).F;
    const double error = (F - matrix_exponential(0.5e-3 * ms * rate_matrix(rate))).norm();
    if (last_error > 0) {
      EXPECT_NEAR(last_error / error, 4, 0.2);
    }
    last_error = error;
  }
}

TEST_F(ThesisModel, NoiseGainIsTheSensitivityToTheRate) {
  // Of the exact step, by central differences; G leaves out terms of second order in the angle.
  constexpr double kStep_rad_s = 1e-4;
  for (auto discretization : {Discretization::exact, Discretization::small_angle}) {
    for (int i = 0; i < 20; ++i) {
      const auto q = random_quaternion();
      const auto rate = random_rate(1);
      const auto interval = milliseconds(5);
      const auto G = discretize(discretization, rate, interval, q).G;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d change = kStep_rad_s * Eigen::Vector3d::Unit(axis);
        const auto stepped = [&](const Eigen::Vector3d& at) -> QuaternionVector {
          return discretize(Discretization::exact, at, interval, q).F * q;
        };
        const QuaternionVector sensitivity =
            (stepped(rate + change) - stepped(rate - change)) / (2 * kStep_rad_s);
        const double angle = rate.norm() * to_seconds(interval);
        EXPECT_LT((G.col(axis) - sensitivity).norm(), sensitivity.norm() * angle);
      }
    }
  }
}

TEST_F(ThesisModel, SpecificForceAtRestPointsUpInTheWorld) {
  for (int i = 0; i < 20; ++i) {
    const auto q = random_quaternion();
    const Eigen::Vector3d accel_world = to_quaternion(q) * accel_at_rest(q);
    EXPECT_LT((accel_world - Eigen::Vector3d(0, 0, 9.80665)).norm(), 1e-13);
  }
}

TEST_F(ThesisModel, JacobianIsTheDerivativeOfTheMeasurement) {
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 20; ++i) {
    const auto q = random_quaternion();
    const auto H = accel_jacobian(q);
    for (int component = 0; component < 4; ++component) {
      const QuaternionVector change = kStep * QuaternionVector::Unit(component);
      const Eigen::Vector3d derivative =
          (accel_at_rest(q + change) - accel_at_rest(q - change)) / (2 * kStep);
      EXPECT_LT((H.col(component) - derivative).norm(), 1e-8);
    }
  }
}

}  // namespace
}  // namespace gimbal

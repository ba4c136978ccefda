#include "pipeline/estimator/error_state_filter.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace gimbal {
namespace {

using Index = ErrorIndex;

Eigen::Vector3d tumbling_rate(double t_s) {
  return {1.1 * std::sin(1.3 * t_s), 0.9 * std::cos(0.7 * t_s), 0.5 + 0.8 * std::sin(0.4 * t_s)};
}

ErrorCovariance some_covariance() {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  ErrorCovariance A;
  for (int i = 0; i < Index::size; ++i) {
    for (int j = 0; j < Index::size; ++j) A(i, j) = normal(random);
  }
  return A * A.transpose();
}

/// A filter that tumbles at rest for 20 ms; `mean` as it was at the start.
ErrorStateFilter tumble(const InertialState& mean, const Eigen::Quaterniond& q_true) {
  ErrorStateFilter filter;
  filter.mean() = mean;
  Eigen::Quaterniond q = q_true;
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d rate = tumbling_rate(1 + 0.002 * i);
    const Eigen::Quaterniond q_middle = q * rotation_from_vector(0.001 * rate);
    const Eigen::Vector3d force = q_middle.conjugate() * Eigen::Vector3d(0, 0, kGravity_m_s2);
    filter.advance(rate, force, 0.002, {});
    q = q * rotation_from_vector(0.002 * rate);
  }
  return filter;
}

ErrorState difference(const InertialState& a, const InertialState& b) {
  ErrorState d;
  d.segment<3>(Index::attitude) = vector_from_rotation(a.q_world_imu * b.q_world_imu.conjugate());
  d.segment<3>(Index::gyro_bias) = a.gyro_bias_rad_s - b.gyro_bias_rad_s;
  d.segment<3>(Index::velocity) = a.velocity_m_s - b.velocity_m_s;
  d.segment<3>(Index::accel_bias) = a.accel_bias_m_s2 - b.accel_bias_m_s2;
  d.segment<3>(Index::gyro_scale) = a.gyro_scale - b.gyro_scale;
  d(Index::accel_scale) = a.accel_scale - b.accel_scale;
  return d;
}

ErrorCovariance dense(const ErrorTransition& F) {
  const MovingColumns back = F.back_from_attitude_and_velocity();
  ErrorCovariance M = ErrorCovariance::Identity();
  M.middleRows<3>(Index::attitude) += back.leftCols<3>().transpose();
  M.middleRows<3>(Index::velocity) += back.rightCols<3>().transpose();
  return M;
}

TEST(ErrorTransition, IsTheNumericalJacobianOfTheMean) {
  const Eigen::Quaterniond q = rotation_from_vector({0.4, -0.3, 1.0});
  InertialState mean;
  mean.q_world_imu = q;
  ErrorStateFilter filter = tumble(mean, q);
  const InertialState after = filter.mean();
  const ErrorCovariance F = dense(filter.close_step({}));
  constexpr double kStep = 1e-5;
  for (int i = 0; i < Index::size; ++i) {
    InertialState changed = mean;
    changed.correct(kStep * ErrorState::Unit(i));
    const ErrorState column = difference(tumble(changed, q).mean(), after) / kStep;
    // What is left is the curvature of the turn within the 20 ms.
    EXPECT_LT((column - F.col(i)).norm(), 2e-4) << "component " << i;
  }
}

TEST(ErrorTransition, PropagatesAsTheDenseProduct) {
  const Eigen::Quaterniond q = rotation_from_vector({0.4, -0.3, 1.0});
  InertialState mean;
  mean.q_world_imu = q;
  const ErrorTransition F = tumble(mean, q).close_step({});
  const ErrorCovariance P = some_covariance();
  ErrorCovariance propagated = P;
  F.propagate(propagated);
  const ErrorCovariance expected = dense(F) * P * dense(F).transpose();
  EXPECT_LT((propagated - expected).norm(), 1e-12 * expected.norm());
  EXPECT_EQ(propagated, propagated.transpose());
}

TEST(ErrorStateFilter, MeasuresAsKalmansEquationsSay) {
  ErrorStateFilter filter;
  const ErrorCovariance P = some_covariance();
  filter.covariance() = P;
  const int index = Index::velocity + 1;
  filter.measure(index, 0.25, 0.5);
  Eigen::Matrix<double, 1, Index::size> H = ErrorState::Unit(index).transpose();
  const ErrorState K = P * H.transpose() / (H * P * H.transpose() + 0.5);
  const ErrorCovariance kept = ErrorCovariance::Identity() - K * H;
  const ErrorCovariance joseph = kept * P * kept.transpose() + 0.5 * K * K.transpose();
  EXPECT_LT((filter.covariance() - joseph).norm(), 1e-12 * P.norm());
  EXPECT_LT((filter.mean().gyro_bias_rad_s - 0.25 * K.segment<3>(Index::gyro_bias)).norm(), 1e-12);
}

TEST(ErrorStateFilter, AttitudeCovarianceBetweenStepsIsThatOfTheStep) {
  const Eigen::Quaterniond q = rotation_from_vector({0.4, -0.3, 1.0});
  InertialState mean;
  mean.q_world_imu = q;
  ErrorStateFilter filter = tumble(mean, q);
  filter.covariance() = some_covariance();
  const Eigen::Matrix3d before = filter.attitude_covariance();
  filter.close_step({});
  const Eigen::Matrix3d after = filter.covariance().topLeftCorner<3, 3>();
  EXPECT_LT((before - after).norm(), 1e-12 * after.norm());
}

/// The model that the filter assumes, with every error drawn from it.
class Simulation {
 public:
  explicit Simulation(unsigned seed) : random_(seed) {
    filter_.covariance().diagonal() = start_variance();
    truth_.correct(start_variance().cwiseSqrt().cwiseProduct(draw_error()));
  }

  void run(double seconds) {
    const int steps = static_cast<int>(std::lround(seconds / kStep_s));
    for (int i = 0; i < steps; ++i) {
      for (int k = 0; k < kSamplesPerStep; ++k) sample();
      filter_.close_step({kBiasWalk, kAccelBiasWalk});
      truth_.gyro_bias_rad_s += kBiasWalk * std::sqrt(kStep_s) * draw();
      truth_.accel_bias_m_s2 += kAccelBiasWalk * std::sqrt(kStep_s) * draw();
      const Eigen::Vector3d measured =
          truth_.velocity_m_s + std::sqrt(kVelocityDensity / kStep_s) * draw();
      for (int axis = 0; axis < 3; ++axis) {
        filter_.measure(Index::velocity + axis, measured(axis) - filter_.mean().velocity_m_s(axis),
                        kVelocityDensity / kStep_s);
      }
    }
  }

  /// Squared error of the attitude in units of its covariance: 3 on average.
  [[nodiscard]] double attitude_nees() const {
    const ErrorState error = difference(truth_, filter_.mean());
    const Eigen::Vector3d attitude = error.segment<3>(Index::attitude);
    return attitude.dot(filter_.attitude_covariance().inverse() * attitude);
  }
  [[nodiscard]] double bias_nees() const {
    const ErrorState error = difference(truth_, filter_.mean());
    const Eigen::Vector3d bias = error.segment<3>(Index::gyro_bias);
    return bias.dot(filter_.covariance().block<3, 3>(Index::gyro_bias, Index::gyro_bias).inverse() *
                    bias);
  }

 private:
  static constexpr double kStep_s = 0.02;
  static constexpr int kSamplesPerStep = 4;
  static constexpr double kGyroNoise = 0.002;
  static constexpr double kAccelNoise = 0.05;
  static constexpr double kBiasWalk = 0.0005;
  static constexpr double kAccelBiasWalk = 0.001;
  static constexpr double kVelocityDensity = 0.1;

  static ErrorState start_variance() {
    ErrorState sigma;
    sigma << 0.05, 0.05, 0.01, 0.02, 0.02, 0.02, 0.3, 0.3, 0.3, 0.05, 0.05, 0.05, 0.005, 0.005,
        0.005, 0.01;
    return sigma.cwiseAbs2();
  }

  void sample() {
    const double dt = kStep_s / kSamplesPerStep;
    const Eigen::Vector3d rate = tumbling_rate(t_s_);
    const Eigen::Vector3d noisy_rate = rate + kGyroNoise / std::sqrt(dt) * draw();
    const Eigen::Vector3d gyro =
        truth_.gyro_bias_rad_s +
        noisy_rate.cwiseQuotient(Eigen::Vector3d::Ones() - truth_.gyro_scale);
    const Eigen::Quaterniond q_middle = truth_.q_world_imu * rotation_from_vector(0.5 * dt * rate);
    const Eigen::Vector3d force = q_middle.conjugate() * Eigen::Vector3d(0, 0, kGravity_m_s2) +
                                  kAccelNoise / std::sqrt(dt) * draw();
    const Eigen::Vector3d accel = truth_.accel_bias_m_s2 + force / (1 - truth_.accel_scale);
    IntervalNoise noise;
    noise.attitude_rad2.diagonal().setConstant(kGyroNoise * kGyroNoise * dt);
    noise.velocity_m2_s2 = kAccelNoise * kAccelNoise * dt;
    filter_.advance(gyro, accel, dt, noise);
    truth_.q_world_imu = (truth_.q_world_imu * rotation_from_vector(dt * rate)).normalized();
    t_s_ += dt;
  }

  Eigen::Vector3d draw() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  ErrorState draw_error() {
    ErrorState error;
    for (int i = 0; i < Index::size; ++i) error(i) = normal_(random_);
    return error;
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  InertialState truth_;
  ErrorStateFilter filter_;
  double t_s_ = 0;
};

TEST(ErrorStateFilter, CovarianceIsHonestInItsOwnModel) {
  constexpr int kRuns = 150;
  constexpr std::array kDurations_s = {0.5, 4.5, 10.0};
  std::vector<Simulation> simulations;
  for (unsigned run = 0; run < kRuns; ++run) simulations.emplace_back(run);
  // Mean of chi-square with 3 degrees of freedom over the runs, 95 %.
  const double band = 1.96 * std::sqrt(6.0 / kRuns);
  for (const double duration_s : kDurations_s) {
    double attitude = 0;
    double bias = 0;
    for (Simulation& simulation : simulations) {
      simulation.run(duration_s);
      attitude += simulation.attitude_nees() / kRuns;
      bias += simulation.bias_nees() / kRuns;
    }
    EXPECT_NEAR(attitude, 3, band) << "after " << duration_s << " s more";
    EXPECT_NEAR(bias, 3, band) << "after " << duration_s << " s more";
  }
}

}  // namespace
}  // namespace gimbal

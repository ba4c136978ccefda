// Whether the covariance of an answer says how wrong the answer is: NEES, the normalized estimation
// error squared, averaged over many runs (Bar-Shalom, Li, Kirubarajan, "Estimation with
// Applications to Tracking and Navigation", 5.4.2). The truth is simulated apart from the filter.

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "pipeline/smoother/fixed_lag_smoother.hpp"

namespace gimbal {
namespace {

constexpr double kInterval_s = 0.01;
constexpr double kDuration_s = 40;
constexpr int kRuns = 100;

// A hand: velocity of 0.55 m/s and rate of 0.5 rad/s, an axis, whose integrals wander as the
// filter's parameters have it. What the sensors do is drawn from those parameters.
constexpr double kVelocityMemory_s = 0.5;
constexpr double kVelocityDensity_m2_s = 0.6;
constexpr double kRate_rad_s = 0.5;
constexpr double kRateMemory_s = 0.27;

struct Device {
  Eigen::Vector3d gyro_bias_rad_s;
  Eigen::Vector3d gyro_scale;
  Eigen::Vector3d accel_bias_m_s2;
  double accel_scale;
};

struct Session {
  std::vector<ImuSample> samples;
  std::vector<Eigen::Quaterniond> truth;
  std::vector<Eigen::Vector3d> gyro_bias_rad_s;
};

class Simulation {
 public:
  explicit Simulation(unsigned seed) : random_(seed) {}

  Session run() {
    const AttitudeEkfParameters p;
    Session session;
    Device device{draw().cwiseProduct(p.gyro_bias.sigma_rad_s), p.gyro_scale_sigma * draw(),
                  p.accel_bias_sigma_m_s2 * draw(), p.accel_scale_sigma * normal_(random_)};
    Eigen::Quaterniond q = rotation_about(0.5 * draw());
    Eigen::Vector3d rate = kRate_rad_s * draw();
    for (int i = 0; i * kInterval_s <= kDuration_s; ++i) {
      const Eigen::Vector3d acceleration = (drive_m_s_ - velocity_m_s_) / kVelocityMemory_s;
      const Eigen::Vector3d force = q.conjugate() * (acceleration + Eigen::Vector3d(0, 0, 9.81));
      const double rate_noise =
          std::hypot(p.gyro_noise_rad_s_rthz, p.gyro_misfit_rts * rate.norm());
      const double force_noise =
          std::hypot(p.accel_noise_m_s2_rthz, p.accel_misfit_rts * acceleration.norm());
      session.samples.push_back(
          {time_from_seconds(1 + i * kInterval_s),
           rate + device.gyro_scale.cwiseProduct(rate) + device.gyro_bias_rad_s +
               rate_noise / std::sqrt(kInterval_s) * draw(),
           Eigen::Vector3d((1 + device.accel_scale) * force + device.accel_bias_m_s2 +
                           force_noise / std::sqrt(kInterval_s) * draw())});
      session.truth.push_back(q);
      session.gyro_bias_rad_s.push_back(device.gyro_bias_rad_s);
      const double kept = std::exp(-kInterval_s / kRateMemory_s);
      const Eigen::Vector3d next = kept * rate + kRate_rad_s * std::sqrt(1 - kept * kept) * draw();
      q = (q * rotation_about(0.5 * kInterval_s * (rate + next))).normalized();
      rate = next;
      move();
      device.gyro_bias_rad_s += p.gyro_bias_walk_rad_s_rts * std::sqrt(kInterval_s) * draw();
      device.accel_bias_m_s2 += p.accel_bias_walk_m_s2_rts * std::sqrt(kInterval_s) * draw();
    }
    return session;
  }

 private:
  Eigen::Vector3d draw() {
    const double x = normal_(random_);
    const double y = normal_(random_);
    return {x, y, normal_(random_)};
  }

  static Eigen::Quaterniond rotation_about(const Eigen::Vector3d& v) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(v.norm(), v.stableNormalized()));
  }

  /// Velocity follows a drive, which is itself a white noise through a low-pass.
  void move() {
    const double k = kInterval_s / kVelocityMemory_s;
    velocity_m_s_ += k * (drive_m_s_ - velocity_m_s_);
    drive_m_s_ += -k * drive_m_s_ +
                  std::sqrt(kVelocityDensity_m2_s * kInterval_s) / kVelocityMemory_s * draw();
  }

  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Eigen::Vector3d velocity_m_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d drive_m_s_ = Eigen::Vector3d::Zero();
};

/// The mean over runs, per degree of freedom: 1 where the covariance is right.
struct Nees {
  double sum = 0;
  int freedom = 0;

  template <int size>
  void add(const Eigen::Matrix<double, size, 1>& error,
           const Eigen::Matrix<double, size, size>& covariance) {
    sum += error.dot(covariance.inverse() * error);
    freedom += size;
  }
  [[nodiscard]] double mean() const { return sum / freedom; }
  /// Half of the band that holds 95 % of such means: a chi-square of many is normal.
  [[nodiscard]] double half_band() const { return 1.96 * std::sqrt(2.0 / freedom); }
};

double heading_of(const Eigen::Quaterniond& turn) {
  return 2 * std::atan2(turn.z(), turn.w());
}

struct Consistency {
  Nees tilt;
  Nees heading;

  /// Heading is judged against the first answer's.
  void add(const Eigen::Quaterniond& truth, const AttitudeEstimate& answer, double first_heading) {
    const Eigen::Quaterniond& q = answer.attitude.q_world_imu;
    const Eigen::Quaterniond world(Eigen::AngleAxisd(first_heading, Eigen::Vector3d::UnitZ()));
    const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d tilt_error = (q * (truth.conjugate() * z)).cross(z);
    tilt.add<2>(tilt_error.head<2>(), answer.covariance_rad2.topLeftCorner<2, 2>());
    const double heading_error =
        std::remainder(heading_of(truth * (world * q).conjugate()), 2 * std::numbers::pi);
    heading.add<1>(Eigen::Matrix<double, 1, 1>(heading_error),
                   answer.covariance_rad2.bottomRightCorner<1, 1>());
  }
};

constexpr std::size_t kJudgedAt = 3000;  ///< a sample of each run: runs are independent

Session session(int run) {
  return Simulation(static_cast<unsigned>(run)).run();
}

double first_heading(const Session& session, const Attitude& first) {
  return heading_of(session.truth.front() * first.q_world_imu.conjugate());
}

void expect_honest(const Nees& nees) {
  EXPECT_NEAR(nees.mean(), 1, nees.half_band());
}

TEST(AttitudeConsistency, TheFiltersCovarianceIsHonest) {
  Consistency answers;
  Nees bias;
  for (int run = 0; run < kRuns; ++run) {
    const Session hand = session(run);
    AttitudeEkf ekf;
    const double heading = first_heading(hand, ekf.update(hand.samples.front()));
    for (std::size_t i = 1; i <= kJudgedAt; ++i) ekf.update(hand.samples[i]);
    answers.add(hand.truth[kJudgedAt], ekf.predict(hand.samples[kJudgedAt].time), heading);
    const Eigen::Vector3d sigma = ekf.gyro_bias().sigma_rad_s;
    bias.add<3>(ekf.gyro_bias().bias_rad_s - hand.gyro_bias_rad_s[kJudgedAt],
                sigma.cwiseAbs2().asDiagonal());
  }
  expect_honest(answers.tilt);
  expect_honest(answers.heading);
  expect_honest(bias);
}

class SmootherConsistency : public ::testing::TestWithParam<SmootherLag> {};

TEST_P(SmootherConsistency, TheCovarianceIsHonest) {
  Consistency answers;
  FixedLagSmootherParameters parameters;
  parameters.lag = GetParam();
  for (int run = 0; run < kRuns; ++run) {
    const Session hand = session(run);
    FixedLagSmoother smoother(parameters);
    for (const ImuSample& sample : hand.samples) smoother.push(sample);
    smoother.finish();
    const double heading = first_heading(hand, smoother.pop()->attitude);
    for (std::size_t i = 1; i < kJudgedAt; ++i) static_cast<void>(smoother.pop());
    answers.add(hand.truth[kJudgedAt], smoother.pop().value(), heading);
  }
  expect_honest(answers.tilt);
  expect_honest(answers.heading);
}

INSTANTIATE_TEST_SUITE_P(Lags, SmootherConsistency,
                         ::testing::Values(SmootherLag(std::chrono::seconds(1)), SmootherLag()));

}  // namespace
}  // namespace gimbal

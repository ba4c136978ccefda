#include "pipeline/estimator/attitude_ekf.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr double kDegree = std::numbers::pi / 180;
const Eigen::Vector3d kUp(0, 0, kGravity_m_s2);

struct Moment {
  Eigen::Quaterniond q_world_imu;
  ImuSample sample;
};

/// A hand: turns by all axes within `amplitude` (rad), moves within some centimetres. True rates
/// and forces at each stamp's instant; 200 Hz.
std::vector<Moment> handheld(double duration_s, double amplitude_rad) {
  const auto attitude = [&](double t) {
    return rotation_from_vector(amplitude_rad * Eigen::Vector3d(std::sin(2.1 * t), 0, 0)) *
           rotation_from_vector(amplitude_rad * Eigen::Vector3d(0, std::sin(1.4 * t + 1), 0)) *
           rotation_from_vector(amplitude_rad * Eigen::Vector3d(0, 0, std::sin(0.9 * t + 2)));
  };
  const auto acceleration = [](double t) {
    return Eigen::Vector3d(1.2 * std::sin(7 * t), 0.8 * std::sin(5 * t + 1), 0.6 * std::cos(9 * t));
  };
  constexpr double kInterval_s = 0.005;
  constexpr double kInstant_s = 1e-4;
  std::vector<Moment> moments;
  for (int i = 1; i * kInterval_s <= duration_s; ++i) {
    const double t = i * kInterval_s;
    const Eigen::Quaterniond q = attitude(t);
    const Eigen::Vector3d turn = vector_from_rotation(attitude(t - kInstant_s / 2).conjugate() *
                                                      attitude(t + kInstant_s / 2));
    moments.push_back(
        {q, {time_from_seconds(t), turn / kInstant_s, q.conjugate() * (acceleration(t) + kUp)}});
  }
  return moments;
}

double tilt_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const double cosine = (a.conjugate() * z).dot(b.conjugate() * z);
  return std::acos(std::clamp(cosine, -1.0, 1.0));
}

ImuSample at_rest(SensorTime time) {
  return {time, Eigen::Vector3d::Zero(), kUp};
}

void rest(AttitudeEkf& ekf, SensorTime from, SensorTime to) {
  for (SensorTime t = from; t <= to; t += milliseconds(5)) ekf.update(at_rest(t));
}

bool is_same(const AttitudeEkf& a, const AttitudeEkf& b) {
  const auto& x = a.state().filter;
  const auto& y = b.state().filter;
  return x.covariance() == y.covariance() &&
         x.mean().q_world_imu.coeffs() == y.mean().q_world_imu.coeffs() &&
         x.mean().gyro_bias_rad_s == y.mean().gyro_bias_rad_s &&
         x.mean().velocity_m_s == y.mean().velocity_m_s &&
         x.mean().accel_bias_m_s2 == y.mean().accel_bias_m_s2;
}

TEST(AttitudeEkf, StartsUprightFromTheFirstForce) {
  const Eigen::Quaterniond q = rotation_from_vector({0.5, -0.8, 0.3});
  AttitudeEkf ekf;
  const Attitude answer =
      ekf.update({SensorTime(seconds(1)), Eigen::Vector3d::Zero(), q.conjugate() * kUp});
  EXPECT_LT(tilt_between(answer.q_world_imu, q), 1e-9);
}

TEST(AttitudeEkf, FollowsAHandThatMovesFromTheFirstSample) {
  AttitudeEkf ekf;
  double worst = 0;
  for (const Moment& moment : handheld(60, 0.8)) {
    const Attitude answer = ekf.update(moment.sample);
    if (moment.sample.time < SensorTime(seconds(15))) continue;
    worst = std::max(worst, tilt_between(answer.q_world_imu, moment.q_world_imu));
  }
  EXPECT_LT(worst, 0.6 * kDegree);
}

// A filter that takes the first tilt error for small needs 10 s and more for this.
TEST(AttitudeEkf, AStartInHarshMotionIsMendedWithinSeconds) {
  double after_a_second = 0;
  double after_three = 0;
  constexpr std::size_t kStarts = 40;
  const std::vector<Moment> moments = handheld(60, 0.8);
  for (std::size_t start = 0; start < kStarts; ++start) {
    AttitudeEkf ekf;
    double first = 0;
    for (std::size_t i = 0; i < 700; ++i) {
      const auto& [q, sample] = moments[start * 240 + i];
      // Shaken by 10 m/s², three times a second.
      const double t = seconds_since_epoch(sample.time);
      const Eigen::Vector3d shake(10 * std::sin(19 * t), 8 * std::cos(17 * t),
                                  6 * std::sin(23 * t));
      const Attitude answer =
          ekf.update({sample.time, sample.gyro_rad_s,
                      Eigen::Vector3d(*sample.accel_m_s2 + q.conjugate() * shake)});
      const double error = tilt_between(answer.q_world_imu, q);
      if (i == 0) first = error;
      if (i == 200) after_a_second += error * error / kStarts;
      if (i == 600) after_three += error * error / kStarts;
    }
    if (start == 0) {
      EXPECT_GT(first, 20 * kDegree);
    }
  }
  EXPECT_LT(std::sqrt(after_a_second), 6 * kDegree);
  EXPECT_LT(std::sqrt(after_three), 3 * kDegree);
}

TEST(AttitudeEkf, WithoutAnAccelerometerTheWorldIsTheFirstFrame) {
  AttitudeEkf ekf;
  const Eigen::Vector3d rate(0.3, -1.1, 0.7);
  Attitude answer;
  for (int i = 0; i <= 400; ++i) {
    // Turning at full speed from the first sample: no hint of a bias.
    answer = ekf.update({SensorTime(milliseconds(5 * i)), rate, std::nullopt});
  }
  EXPECT_LT(answer.q_world_imu.angularDistance(rotation_from_vector(2.0 * rate)), 1e-3);
}

TEST(AttitudeEkf, LearnsABiasOfFiveDegreesASecondFromAHand) {
  const Eigen::Vector3d bias = Eigen::Vector3d(4, 1, -3) * kDegree;
  AttitudeEkf ekf;
  for (Moment moment : handheld(60, 0.8)) {
    moment.sample.gyro_rad_s += bias;
    ekf.update(moment.sample);
  }
  // Its part about the vertical shows only as far as the hand turns that axis away.
  EXPECT_LT((ekf.gyro_bias().bias_rad_s - bias).norm(), 1.2 * kDegree);
}

TEST(AttitudeEkf, LearnsABiasAtRestAboutTheVerticalTooDespiteVibration) {
  const Eigen::Vector3d bias = Eigen::Vector3d(0.5, -0.4, 0.8) * kDegree;
  AttitudeEkf ekf;
  std::mt19937 random(5);
  std::normal_distribution<double> vibration(0, 1);
  for (int i = 0; i < 4000; ++i) {
    // Motors: 0.1 rad/s and 3 m/s² from sample to sample.
    const Eigen::Vector3d shake(vibration(random), vibration(random), vibration(random));
    ekf.update({SensorTime(milliseconds(5 * i)), bias + 0.1 * shake, kUp + 3 * shake});
  }
  EXPECT_LT((ekf.gyro_bias().bias_rad_s - bias).norm(), 0.3 * kDegree);
}

TEST(AttitudeEkf, APanAfterARestIsNoBias) {
  // Slower ones could be a bias. The tremor alone costs the rest's bias 0.3 deg/s.
  for (const double pan_rad_s : {3 * kDegree, 5 * kDegree, 9 * kDegree}) {
    AttitudeEkf ekf;
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Eigen::Vector3d tremor = Eigen::Vector3d::Zero();  // 0.01 rad/s with a memory of 30 ms
    double heading_rad = 0;
    Attitude answer;
    for (int i = 0; i < 3000; ++i) {
      for (double& rate : tremor) rate += -rate / 6 + 0.01 * std::sqrt(2.0 / 6) * normal(random);
      const Eigen::Vector3d pan(0, 0, i < 1000 ? 0 : pan_rad_s);
      answer = ekf.update({SensorTime(milliseconds(5 * i)), pan + tremor, kUp});
      heading_rad += 0.005 * (pan + tremor).z();
    }
    const Eigen::Quaterniond& q = answer.q_world_imu;
    const double error_rad =
        std::remainder(2 * std::atan2(q.z(), q.w()) - heading_rad, 2 * std::numbers::pi);
    EXPECT_LT(std::abs(error_rad), 4 * kDegree) << "of 10 s at " << pan_rad_s << " rad/s";
  }
}

TEST(AttitudeEkf, AWarmStartKnowsTheBiasFromTheFirstSample) {
  AttitudeEkfParameters parameters;
  parameters.gyro_bias.bias_rad_s = {0.1, 0, -0.05};
  parameters.gyro_bias.sigma_rad_s.setConstant(0.001);
  AttitudeEkf ekf(parameters);
  Attitude answer;
  for (int i = 0; i <= 200; ++i) {
    answer = ekf.update({SensorTime(milliseconds(5 * i)), parameters.gyro_bias.bias_rad_s, kUp});
  }
  EXPECT_LT(answer.q_world_imu.angularDistance(Eigen::Quaterniond::Identity()), 0.05 * kDegree);
}

/// How far the filter's bias is from the true one after a hand moved for so long.
double bias_error(const AttitudeEkfParameters& parameters, const Eigen::Vector3d& bias_rad_s,
                  double duration_s) {
  AttitudeEkf ekf(parameters);
  for (Moment moment : handheld(duration_s, 0.8)) {
    moment.sample.gyro_rad_s += bias_rad_s;
    ekf.update(moment.sample);
  }
  return (ekf.gyro_bias().bias_rad_s - bias_rad_s).norm();
}

TEST(AttitudeEkf, ARememberedBiasHelpsAndAWrongOneDoesNoHarm) {
  const Eigen::Vector3d bias = Eigen::Vector3d(4, 1, -3) * kDegree;
  // So sure was the run before.
  const Eigen::Vector3d sigma = Eigen::Vector3d::Constant(0.02 * kDegree);
  AttitudeEkfParameters right;
  right.remembered_bias = {bias, sigma};
  AttitudeEkfParameters cooled;
  cooled.remembered_bias = {bias + Eigen::Vector3d(0.6, -0.6, 0.5) * kDegree, sigma};  // 1 deg/s
  for (const double after_s : {1, 5, 20, 60}) {
    const double cold = bias_error({}, bias, after_s);
    EXPECT_LT(bias_error(right, bias, after_s), 0.5 * cold) << after_s;
    EXPECT_LT(bias_error(cooled, bias, after_s), cold) << after_s;
  }
}

TEST(AttitudeEkf, ABiasRememberedIsNoSurerThanASensorIsSteady) {
  AttitudeEkfParameters parameters;
  parameters.remembered_bias = {{0.1, 0, 0}, Eigen::Vector3d(0, 1e-4, 9)};
  const GyroBias bias = AttitudeEkf(parameters).gyro_bias();
  EXPECT_EQ(bias.bias_rad_s, parameters.remembered_bias->bias_rad_s);
  EXPECT_DOUBLE_EQ(bias.sigma_rad_s.x(), parameters.bias_change_between_runs_rad_s);
  EXPECT_DOUBLE_EQ(bias.sigma_rad_s.z(), parameters.gyro_bias.sigma_rad_s.z());
}

TEST(AttitudeEkf, AccelerationNeverTurnsTheHeading) {
  AttitudeEkf ekf;
  Attitude answer;
  for (int i = 0; i <= 3000; ++i) {
    const double t = 0.005 * i;
    const Eigen::Vector3d push = t < 5
                                     ? Eigen::Vector3d::Zero()
                                     : Eigen::Vector3d(6 * std::sin(3 * t), 4 * std::cos(2 * t), 0);
    answer = ekf.update({time_from_seconds(t), Eigen::Vector3d::Zero(), kUp + push});
  }
  const Eigen::Quaterniond& q = answer.q_world_imu;
  EXPECT_LT(std::abs(2 * std::atan2(q.z(), q.w())), 0.2 * kDegree);
}

TEST(AttitudeEkf, TheShownHeadingHasNoStepsWhileABiasIsLearned) {
  AttitudeEkf ekf;
  std::optional<Eigen::Quaterniond> last;
  for (Moment moment : handheld(20, 0.8)) {
    moment.sample.gyro_rad_s.z() += 5 * kDegree;
    const Eigen::Quaterniond q = ekf.update(moment.sample).q_world_imu;
    if (last) {
      const Eigen::Quaterniond by_gyro =
          *last * rotation_from_vector(0.005 * moment.sample.gyro_rad_s);
      const Eigen::Quaterniond step = q * by_gyro.conjugate();
      // A bias of 5 deg/s is 0.025 degrees a sample; corrections of heading would be degrees.
      EXPECT_LT(std::abs(2 * std::atan2(step.z(), step.w())), 0.06 * kDegree);
    }
    last = q;
  }
}

TEST(AttitudeEkf, SkipsBadSamplesAsIfTheyHadNotBeen) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  AttitudeEkf clean;
  AttitudeEkf dirty;
  for (const Moment& moment : handheld(5, 0.8)) {
    clean.update(moment.sample);
    dirty.update(moment.sample);
    const SensorTime time = moment.sample.time;
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e300}) {
      const Attitude answer =
          dirty.update({time + milliseconds(1), Eigen::Vector3d(0, bad, 0), kUp});
      EXPECT_TRUE(answer.q_world_imu.coeffs().allFinite());
    }
    dirty.update({time, Eigen::Vector3d::Ones(), kUp});               // repeated
    dirty.update({time - seconds(1), Eigen::Vector3d::Ones(), kUp});  // backward
  }
  EXPECT_TRUE(is_same(clean, dirty));
  EXPECT_EQ(dirty.counts().skipped_gyro, 6 * 1000u);
}

TEST(AttitudeEkf, ABadForceIsAsNone) {
  AttitudeEkf with_bad;
  AttitudeEkf with_none;
  int i = 0;
  for (Moment moment : handheld(5, 0.8)) {
    if (++i % 7 == 0) {
      moment.sample.accel_m_s2->x() = std::numeric_limits<double>::quiet_NaN();
      with_bad.update(moment.sample);
      moment.sample.accel_m_s2.reset();
      with_none.update(moment.sample);
    } else {
      with_bad.update(moment.sample);
      with_none.update(moment.sample);
    }
  }
  EXPECT_TRUE(is_same(with_bad, with_none));
  EXPECT_GT(with_bad.counts().skipped_accel, 100u);
}

TEST(AttitudeEkf, RestoredStateGoesOnToTheBit) {
  AttitudeEkf original;
  AttitudeEkf other;
  const std::vector<Moment> moments = handheld(10, 0.8);
  for (std::size_t i = 0; i < 1003; ++i) original.update(moments[i].sample);
  other.restore(original.state());
  for (std::size_t i = 1003; i < moments.size(); ++i) {
    const Attitude a = original.update(moments[i].sample);
    const Attitude b = other.update(moments[i].sample);
    ASSERT_EQ(a.q_world_imu.coeffs(), b.q_world_imu.coeffs());
  }
  EXPECT_TRUE(is_same(original, other));
}

/// What a pause of 300 ms adds to the variance of the tilt.
double growth_over_a_pause(AttitudeEkf& ekf, SensorTime last) {
  const double before = ekf.predict(last).covariance_rad2(0, 0);
  ekf.update({last + milliseconds(300), Eigen::Vector3d::Zero(), kUp});
  EXPECT_EQ(ekf.counts().gaps, 1u);
  return ekf.predict(last + milliseconds(300)).covariance_rad2(0, 0) - before;
}

TEST(AttitudeEkf, GapsGrowTheCovarianceByHowFastTheRateChanges) {
  AttitudeEkf moving;
  const std::vector<Moment> moments = handheld(10, 0.8);
  for (const Moment& moment : moments) moving.update(moment.sample);
  AttitudeEkf resting;
  rest(resting, SensorTime(seconds(0)), SensorTime(seconds(10)));
  const double at_rest_rad2 = growth_over_a_pause(resting, SensorTime(seconds(10)));
  EXPECT_GT(growth_over_a_pause(moving, moments.back().sample.time), at_rest_rad2 + 2e-5);
}

TEST(AttitudeEkf, RecoversFromAHoleOfTenSeconds) {
  AttitudeEkf ekf;
  rest(ekf, SensorTime(seconds(0)), SensorTime(seconds(5)));
  const Eigen::Quaterniond q_new = rotation_from_vector({1.2, 0.4, 0});
  Attitude answer;
  for (int i = 0; i <= 200; ++i) {
    answer = ekf.update({SensorTime(seconds(15) + milliseconds(5 * i)), Eigen::Vector3d::Zero(),
                         q_new.conjugate() * kUp});
    // The first sample alone could be a wrong stamp.
    if (i > 0) {
      EXPECT_LT(tilt_between(answer.q_world_imu, q_new), 1 * kDegree);
    }
  }
  EXPECT_EQ(ekf.counts().restarts, 1u);
  const Eigen::Matrix3d covariance = ekf.predict(answer.time).covariance_rad2;
  EXPECT_GT(covariance(2, 2), 1);  // nobody knows where it points now
  EXPECT_LT(covariance(0, 0), 0.1);
}

TEST(AttitudeEkf, ARecoversFromAHoleWithoutForceAfterIt) {
  AttitudeEkf ekf;
  rest(ekf, SensorTime(seconds(0)), SensorTime(seconds(5)));
  ekf.update({SensorTime(seconds(15)), Eigen::Vector3d::Zero(), std::nullopt});
  EXPECT_GT(ekf.predict(SensorTime(seconds(15))).covariance_rad2(0, 0), 1);
  const Eigen::Quaterniond q_new = rotation_from_vector({1.2, 0.4, 0});
  const Attitude answer = ekf.update({SensorTime(seconds(15) + milliseconds(5)),
                                      Eigen::Vector3d::Zero(), q_new.conjugate() * kUp});
  EXPECT_LT(tilt_between(answer.q_world_imu, q_new), 1e-6);
}

class MissedTurn : public ::testing::TestWithParam<double> {};

TEST_P(MissedTurn, IsNoticedAndTheTiltFoundAnew) {
  // The device turns at 20 s without a rate that tells of it: the filter is sure of the old tilt.
  const Eigen::Quaterniond turn = rotation_from_vector({0, GetParam(), 0});
  AttitudeEkf ekf;
  double worst = 0;
  for (Moment moment : handheld(60, 0.8)) {
    const double t = seconds_since_epoch(moment.sample.time);
    if (t > 20) {
      *moment.sample.accel_m_s2 += moment.q_world_imu.conjugate() * (turn.conjugate() * kUp - kUp);
      moment.q_world_imu = turn * moment.q_world_imu;
    }
    const Attitude answer = ekf.update(moment.sample);
    if (t > 35) worst = std::max(worst, tilt_between(answer.q_world_imu, moment.q_world_imu));
  }
  EXPECT_LT(worst, 3 * kDegree);
  EXPECT_EQ(ekf.counts().realignments, 1U);
}

INSTANTIATE_TEST_SUITE_P(Turns, MissedTurn,
                         ::testing::Values(30 * kDegree, -90 * kDegree, 180 * kDegree));

TEST(AttitudeEkf, NoTiltIsFoundAnewInAFastCar) {
  // To 100 km/h within ten seconds, then an emergency stop; level, since nothing turns.
  AttitudeEkf ekf;
  Attitude answer;
  double worst = 0;
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.005 * i;
    double push_m_s2 = 0;
    if (t > 10 && t < 20) push_m_s2 = 2.8;
    if (t > 21 && t < 24.5) push_m_s2 = -8;
    answer = ekf.update(
        {time_from_seconds(t), Eigen::Vector3d::Zero(), kUp + Eigen::Vector3d(push_m_s2, 0, 0)});
    worst = std::max(worst, tilt_between(answer.q_world_imu, Eigen::Quaterniond::Identity()));
  }
  EXPECT_EQ(ekf.counts().realignments, 0U);
  EXPECT_LT(worst, 3 * kDegree);
}

TEST(AttitudeEkf, AFallTurnsNothing) {
  AttitudeEkf ekf;
  rest(ekf, SensorTime(), SensorTime(seconds(5)));
  Attitude answer;
  for (int i = 1; i <= 800; ++i) {  // four seconds
    answer = ekf.update({SensorTime(seconds(5) + milliseconds(5 * i)), Eigen::Vector3d(0.2, 0, 0),
                         Eigen::Vector3d(0.1, -0.2, 0.1)});
  }
  EXPECT_EQ(ekf.counts().realignments, 0U);
  EXPECT_LT(tilt_between(answer.q_world_imu, rotation_from_vector({0.8, 0, 0})), 4 * kDegree);
}

TEST(AttitudeEkf, AClippedAxisGrowsTheCovarianceAboutItself) {
  AttitudeEkf ekf;
  SensorTime time(seconds(0));
  const auto turn = [&](int samples, double rate_rad_s) {
    for (int i = 0; i < samples; ++i) {
      const double noise = 0.001 * (i % 2);
      time += milliseconds(5);
      ekf.update({time, {noise, -noise, rate_rad_s}, kUp});
    }
  };
  turn(1000, 0);
  const double before = ekf.predict(time).covariance_rad2(2, 2);
  turn(40, 250 * kDegree);
  const Eigen::Matrix3d covariance = ekf.predict(time).covariance_rad2;
  EXPECT_GT(covariance(2, 2), before + 0.1);
  EXPECT_GT(covariance(2, 2), 20 * covariance(0, 0));
  EXPECT_EQ(ekf.counts().lost_samples, 38u);  // a repeat could be chance, two are not
}

TEST(AttitudeEkf, AStuckAxisIsFoundAndTheStateRecovers) {
  AttitudeEkf ekf;
  const std::vector<Moment> moments = handheld(40, 0.8);
  double worst = 0;
  for (const Moment& moment : moments) {
    ImuSample sample = moment.sample;
    const double t = seconds_since_epoch(sample.time);
    if (t > 10 && t < 15) sample.gyro_rad_s.y() = 0.31;
    const Attitude answer = ekf.update(sample);
    ASSERT_TRUE(answer.q_world_imu.coeffs().allFinite());
    if (t > 25) worst = std::max(worst, tilt_between(answer.q_world_imu, moment.q_world_imu));
  }
  EXPECT_LT(worst, 1.5 * kDegree);
  EXPECT_GT(ekf.counts().lost_samples, 700u);
}

TEST(AttitudeEkf, AStuckAxisOfTheAccelerometerDoesNotTiltTheWorld) {
  for (int axis = 0; axis < 3; ++axis) {
    AttitudeEkf ekf;
    const std::vector<Moment> moments = handheld(30, 0.8);
    double worst = 0;
    double last = 0;
    for (const Moment& moment : moments) {
      ImuSample sample = moment.sample;
      const double t = seconds_since_epoch(sample.time);
      if (t > 10 && t < 20) (*sample.accel_m_s2)[axis] = 4;
      const Attitude answer = ekf.update(sample);
      last = tilt_between(answer.q_world_imu, moment.q_world_imu);
      worst = std::max(worst, t > 10 ? last : 0);
    }
    EXPECT_LT(worst, 10 * kDegree) << "axis " << axis;  // until it is found, after a second
    EXPECT_LT(last, 1.5 * kDegree) << "axis " << axis;
    EXPECT_GT(ekf.counts().skipped_accel, 1500U);
  }
}

TEST(AttitudeEkf, OneStampInTheFutureCostsOneSample) {
  AttitudeEkf ekf;
  rest(ekf, SensorTime(), SensorTime(seconds(1)));
  ekf.update(at_rest(SensorTime(std::chrono::hours(1))));
  rest(ekf, SensorTime(milliseconds(1005)), SensorTime(seconds(3)));
  EXPECT_EQ(ekf.counts().skipped_gyro, 1U);
  EXPECT_EQ(ekf.counts().restarts, 0U);
  EXPECT_EQ(ekf.predict(SensorTime(seconds(3))).origin, AttitudeOrigin::exact);
}

TEST(AttitudeEkf, AnAccelerometerThatShowsNothingIsAsNone) {
  AttitudeEkf ekf;
  const double bias_rad_s = 0.05;
  for (int i = 0; i < 20000; ++i) {
    ekf.update({SensorTime(milliseconds(5 * i)), {0, 0, bias_rad_s}, Eigen::Vector3d::Zero()});
  }
  EXPECT_NEAR(ekf.gyro_bias().bias_rad_s.z(), bias_rad_s, 0.005);
  EXPECT_GT(ekf.state().step_count, 4000U);
}

TEST(AttitudeEkf, WhereNothingWasMeasuredTheHeadingStaysUnknown) {
  AttitudeEkf ekf;
  rest(ekf, SensorTime(), SensorTime(seconds(1)));
  for (int i = 0; i < 4; ++i) {  // the force comes back after the rate
    ImuSample sample = at_rest(SensorTime(seconds(11) + milliseconds(5 * i)));
    if (i < 2) sample.accel_m_s2.reset();
    ekf.update(sample);
  }
  const auto covariance = ekf.predict(ekf.state().last->time).covariance_rad2;
  EXPECT_GT(covariance(2, 2), 3);  // rad²: spread over a full turn
  EXPECT_LT(covariance(0, 0), 0.3);
}

TEST(AttitudeEkf, PredictsWithTheLastRate) {
  AttitudeEkf ekf;
  for (int i = 0; i <= 1000; ++i) {
    ekf.update({SensorTime(milliseconds(5 * i)), {0, 0, 1}, kUp});
  }
  const SensorTime last(seconds(5));
  const AttitudeEstimate now = ekf.predict(last);
  EXPECT_EQ(now.origin, AttitudeOrigin::exact);
  const AttitudeEstimate ahead = ekf.predict(last + milliseconds(100));
  EXPECT_EQ(ahead.origin, AttitudeOrigin::predicted);
  const Eigen::Quaterniond turned = now.attitude.q_world_imu * rotation_from_vector({0, 0, 0.1});
  EXPECT_LT(ahead.attitude.q_world_imu.angularDistance(turned), 0.3 * kDegree);
  EXPECT_GT(ahead.covariance_rad2.trace(), now.covariance_rad2.trace());
  EXPECT_EQ(ekf.predict(last - seconds(1)).origin, AttitudeOrigin::predicted);
}

TEST(AttitudeEkf, NamesUnitsThatCannotBe) {
  struct Case {
    double gyro_factor;
    double accel_factor;
    Plausibility expected;
  };
  for (const Case& c :
       {Case{1, 1, Plausibility::plausible}, Case{1, 1 / 9.80665, Plausibility::accel_in_g},
        Case{1, 0.01, Plausibility::accel_too_small}, Case{1, 1000, Plausibility::accel_too_large},
        Case{180 / std::numbers::pi, 1, Plausibility::gyro_in_degrees}}) {
    AttitudeEkf ekf;
    for (Moment moment : handheld(5, 0.8)) {
      moment.sample.gyro_rad_s *= c.gyro_factor;
      *moment.sample.accel_m_s2 *= c.accel_factor;
      const Attitude answer = ekf.update(moment.sample);
      ASSERT_TRUE(answer.q_world_imu.coeffs().allFinite());
    }
    EXPECT_EQ(ekf.plausibility(), c.expected);
    EXPECT_EQ(describe(ekf.plausibility()).empty(), c.expected == Plausibility::plausible);
  }
}

}  // namespace
}  // namespace gimbal

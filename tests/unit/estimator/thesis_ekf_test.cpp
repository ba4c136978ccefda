#include "pipeline/estimator/thesis_ekf.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pipeline/timing/imu_aligner.hpp"

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::numbers::pi;

constexpr double kDegree = pi / 180;

double degrees_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond turn = a.conjugate() * b;
  return 2 * std::atan2(turn.vec().norm(), std::abs(turn.w())) / kDegree;
}

Eigen::Quaterniond turn(double angle_rad, const Eigen::Vector3d& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis.normalized()));
}

std::string log_path(const std::string& file) {
  return std::string(GIMBALD_SHARED) + "/data/logs/iphone-handheld/" + file;
}

std::vector<GyroSample> read_gyro_log() {
  std::ifstream file(log_path("gyro.csv"));
  std::vector<GyroSample> samples;
  for (std::string line; std::getline(file, line);) {
    double t = 0, x = 0, y = 0, z = 0;
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &x, &y, &z) != 4) continue;
    samples.push_back({time_from_seconds(t), {x, y, z}});
  }
  return samples;
}

/// Rates of a hand that shakes a camera hard, 100 Hz, 8 s: of the log from 24 s to 32 s, or without
/// it, seeded ones up to about 3 rad/s that change as fast.
std::vector<Eigen::Vector3d> harsh_rates() {
  std::vector<Eigen::Vector3d> rates;
  for (const auto& sample : read_gyro_log()) {
    if (seconds_since_epoch(sample.time) >= 24) rates.push_back(sample.gyro_rad_s);
  }
  if (!rates.empty()) return rates;
  std::mt19937 random(2);
  std::normal_distribution<double> change_rad_s(0, 0.25);
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  for (int i = 0; i < 800; ++i) {
    const Eigen::Vector3d change(change_rad_s(random), change_rad_s(random), change_rad_s(random));
    rate = 0.97 * rate + change;
    rates.push_back(rate);
  }
  return rates;
}

/// Back and forth through the rates, so that nothing jumps.
std::vector<Eigen::Vector3d> mirrored(const std::vector<Eigen::Vector3d>& rates,
                                      std::size_t count) {
  std::vector<Eigen::Vector3d> repeated;
  const std::size_t period = 2 * rates.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i % period;
    repeated.push_back(at < rates.size() ? rates[at] : rates[period - 1 - at]);
  }
  return repeated;
}

struct LongQuaternion {
  long double w = 1, x = 0, y = 0, z = 0;
};

LongQuaternion operator*(const LongQuaternion& a, const LongQuaternion& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/// Turn at a constant rate for `seconds`: the quaternion's exponential.
LongQuaternion exponential(const Eigen::Vector3d& rate_rad_s, long double seconds) {
  const long double x = rate_rad_s.x(), y = rate_rad_s.y(), z = rate_rad_s.z();
  const long double rate = std::sqrt(x * x + y * y + z * z);
  if (rate == 0) return {};
  const long double s = std::sin(rate * seconds / 2) / rate;
  return {std::cos(rate * seconds / 2), s * x, s * y, s * z};
}

double largest_error_deg(const std::vector<Eigen::Vector3d>& rates, Discretization discretization) {
  constexpr SensorDuration kInterval = milliseconds(10);
  ThesisEkfParameters parameters;
  parameters.discretization = discretization;
  parameters.rate_hold = RateHold::previous;
  ThesisEkf ekf(parameters);
  LongQuaternion truth;
  double largest = 0;
  SensorTime time;
  for (const auto& rate : rates) {
    const auto q = ekf.update({time, rate, std::nullopt}).q_world_imu;
    const Eigen::Quaterniond q_truth(static_cast<double>(truth.w), static_cast<double>(truth.x),
                                     static_cast<double>(truth.y), static_cast<double>(truth.z));
    largest = std::max(largest, degrees_between(q, q_truth));
    truth = truth * exponential(rate, 0.010L);
    time += kInterval;
  }
  return largest;
}

TEST(ThesisEkf, HoldsOrientationOver30SecondsOfHarshMotionWithRatesHeldBetweenSamples) {
  const auto rates = mirrored(harsh_rates(), 3000);
  const double exact_deg = largest_error_deg(rates, Discretization::exact);
  const double small_angle_deg = largest_error_deg(rates, Discretization::small_angle);
  std::cout << "largest error over 30 s of harsh motion: " << exact_deg << " deg with (2.11), "
            << small_angle_deg << " deg with (2.12)\n";
  RecordProperty("exact_deg", std::to_string(exact_deg));
  RecordProperty("small_angle_deg", std::to_string(small_angle_deg));
  EXPECT_LT(exact_deg, 0.001);
  EXPECT_GT(small_angle_deg, exact_deg);
}

TEST(ThesisEkf, FollowsAConstantRate) {
  const Eigen::Vector3d rate(0.3, -1.2, 2.0);
  for (auto hold : {RateHold::previous, RateHold::mean}) {
    ThesisEkfParameters parameters;
    parameters.rate_hold = hold;
    ThesisEkf ekf(parameters);
    double seconds = 0;
    for (int i = 0; i < 500; ++i) {
      seconds += i % 3 == 0 ? 0.004 : 0.011;  // true intervals, not a nominal rate
      const auto attitude = ekf.update({time_from_seconds(seconds), rate, std::nullopt});
      const auto expected = turn(rate.norm() * (seconds - 0.004), rate);
      ASSERT_LT(degrees_between(attitude.q_world_imu, expected), 1e-6);
    }
  }
}

/// Largest error on a coning motion, whose attitude and rate have closed forms: the axis of a turn
/// by a constant angle goes round.
double coning_error_deg(RateHold hold, SensorDuration interval) {
  constexpr double kAngle = 10 * kDegree;
  constexpr double kRound_rad_s = 2 * pi * 1.5;
  ThesisEkfParameters parameters;
  parameters.rate_hold = hold;
  ThesisEkf ekf(parameters);
  const Eigen::Quaterniond start = turn(kAngle, Eigen::Vector3d::UnitX());
  double largest = 0;
  for (SensorDuration time{}; time <= std::chrono::seconds(10); time += interval) {
    const double phase = kRound_rad_s * to_seconds(time);
    const Eigen::Vector3d rate =
        kRound_rad_s * Eigen::Vector3d(-std::sin(kAngle) * std::sin(phase),
                                       std::sin(kAngle) * std::cos(phase), std::cos(kAngle) - 1);
    const Eigen::Vector3d axis(std::cos(phase), std::sin(phase), 0);
    const auto q = ekf.update({SensorTime(time), rate, std::nullopt}).q_world_imu;
    largest = std::max(largest, degrees_between(start * q, turn(kAngle, axis)));
  }
  return largest;
}

TEST(ThesisEkf, FollowsConing) {
  const double coarse = coning_error_deg(RateHold::mean, milliseconds(10));
  const double fine = coning_error_deg(RateHold::mean, milliseconds(5));
  EXPECT_NEAR(coarse / fine, 4, 0.2);  // second order in the interval
  EXPECT_LT(coning_error_deg(RateHold::mean, milliseconds(1)), 0.005);
  EXPECT_GT(coning_error_deg(RateHold::previous, milliseconds(5)), 2 * fine);
}

TEST(ThesisEkf, StartsWithTheTiltOfTheFirstAcceleration) {
  ThesisEkf ekf;
  const Eigen::Quaterniond q = turn(1.1, {1, 2, 0});
  const Eigen::Vector3d up_imu = q.conjugate() * Eigen::Vector3d::UnitZ();
  const auto attitude = ekf.update({SensorTime(), Eigen::Vector3d::Zero(), 9.5 * up_imu});
  EXPECT_LT(degrees_between(attitude.q_world_imu, q), 1e-9);
}

TEST(ThesisEkf, WithoutAccelerometerTheWorldIsTheFirstFrame) {
  ThesisEkf ekf;
  const auto attitude = ekf.update({SensorTime(), {1, 2, 3}, std::nullopt});
  EXPECT_EQ(attitude.q_world_imu, Eigen::Quaterniond::Identity());
}

TEST(ThesisEkf, AccelerationThatComesLateSetsTheTilt) {
  ThesisEkf ekf;
  ekf.update({SensorTime(milliseconds(0)), Eigen::Vector3d::Zero(), std::nullopt});
  ekf.update({SensorTime(milliseconds(10)), Eigen::Vector3d::Zero(), std::nullopt});
  const auto attitude = ekf.update(
      {SensorTime(milliseconds(20)), Eigen::Vector3d::Zero(), Eigen::Vector3d(0, 9.8, 0)});
  EXPECT_NEAR((attitude.q_world_imu * Eigen::Vector3d::UnitY()).z(), 1, 1e-12);
}

TEST(ThesisEkf, TiltConvergesFromAWrongStartAgainstStaticGravity) {
  for (SensorDuration interval : {milliseconds(10), milliseconds(2)}) {
    ThesisEkf ekf;
    const Eigen::Quaterniond right = turn(0.7, {1, -0.4, 0});
    const Eigen::Vector3d accel = right.conjugate() * Eigen::Vector3d(0, 0, 9.80665);
    const Eigen::Vector3d level = accel.cross(Eigen::Vector3d(0.3, 1, 0.5));
    const Eigen::Vector3d wrong_accel = turn(30 * kDegree, level) * accel;
    const Eigen::Quaterniond start =
        ekf.update({SensorTime(), Eigen::Vector3d::Zero(), wrong_accel}).q_world_imu;
    // The shortest way from the start to where gravity is upright: heading has no say in it.
    const Eigen::Quaterniond end =
        Eigen::Quaterniond::FromTwoVectors(start * accel, Eigen::Vector3d::UnitZ()) * start;
    EXPECT_NEAR(degrees_between(start, end), 30, 1e-9);

    Attitude attitude{};
    for (SensorDuration t = interval; t <= std::chrono::seconds(90); t += interval) {
      attitude = ekf.update({SensorTime(t), Eigen::Vector3d::Zero(), accel});
    }
    EXPECT_LT(degrees_between(attitude.q_world_imu, end), 0.05);
  }
}

/// The IMU's true attitude under rates that are held between samples.
std::vector<Eigen::Quaterniond> true_attitudes(const std::vector<Eigen::Vector3d>& rates,
                                               Eigen::Quaterniond q) {
  std::vector<Eigen::Quaterniond> attitudes;
  for (const auto& rate : rates) {
    attitudes.push_back(q);
    q = (q * turn(rate.norm() * 0.010, rate)).normalized();
  }
  return attitudes;
}

ThesisEkfParameters held_rates() {
  ThesisEkfParameters parameters;
  parameters.rate_hold = RateHold::previous;
  return parameters;
}

TEST(ThesisEkf, ExactGravityChangesNothingWhileTheTiltIsRight) {
  const auto rates = mirrored(harsh_rates(), 3000);
  const auto truth = true_attitudes(rates, Eigen::Quaterniond::Identity());
  ThesisEkf with_accel(held_rates()), gyro_only(held_rates());
  for (std::size_t i = 0; i < rates.size(); ++i) {
    const SensorTime time(milliseconds(10 * i));
    const Eigen::Vector3d accel = truth[i].conjugate() * Eigen::Vector3d(0, 0, 9.80665);
    const auto a = with_accel.update({time, rates[i], accel});
    const auto b = gyro_only.update({time, rates[i], std::nullopt});
    ASSERT_LT(degrees_between(a.q_world_imu, b.q_world_imu), 1e-6);
  }
}

TEST(ThesisEkf, ExactGravityCorrectsTiltAndNeverHeadingWhileMoving) {
  // The first acceleration is 5 degrees off, gravity and rates are exact from then on: the
  // attitude's error, seen in the world, starts about a level axis and has to shrink about that
  // axis.
  const auto rates = mirrored(harsh_rates(), 6000);
  const auto truth = true_attitudes(rates, turn(0.4, {1, 1, 0}));
  const auto accel_at = [&](std::size_t i) -> Eigen::Vector3d {
    return truth[i].conjugate() * Eigen::Vector3d(0, 0, 9.80665);
  };
  ThesisEkf ekf(held_rates());
  const Eigen::Vector3d wrong_accel = turn(5 * kDegree, {1, 0, 0}) * accel_at(0);
  const auto start = ekf.update({SensorTime(), rates[0], wrong_accel}).q_world_imu;
  const auto upright =
      Eigen::Quaterniond::FromTwoVectors(start * accel_at(0), Eigen::Vector3d::UnitZ());
  const Eigen::Quaterniond heading = upright * start * truth[0].conjugate();  // arbitrary, but kept
  Attitude attitude{};
  double largest_heading_deg = 0;
  for (std::size_t i = 1; i < rates.size(); ++i) {
    attitude = ekf.update({SensorTime(milliseconds(10 * i)), rates[i], accel_at(i)});
    const Eigen::Quaterniond error = attitude.q_world_imu * (heading * truth[i]).conjugate();
    largest_heading_deg =
        std::max(largest_heading_deg, std::abs(2 * std::atan2(error.z(), error.w())) / kDegree);
  }
  EXPECT_LT(largest_heading_deg, 0.1);
  EXPECT_LT(degrees_between(attitude.q_world_imu, heading * truth.back()), 0.1);
}

TEST(ThesisEkf, CovarianceStaysSymmetricAndPositiveSemidefinite) {
  const auto rates = mirrored(harsh_rates(), 6000);
  std::mt19937 random(4);
  std::normal_distribution<double> noise_m_s2(0, 3);
  for (auto discretization : {Discretization::exact, Discretization::small_angle}) {
    ThesisEkfParameters parameters;
    parameters.discretization = discretization;
    ThesisEkf ekf(parameters);
    for (std::size_t i = 0; i < rates.size(); ++i) {
      const Eigen::Vector3d accel(noise_m_s2(random), noise_m_s2(random), 9.8 + noise_m_s2(random));
      ekf.update({SensorTime(milliseconds(10 * i)), 3 * rates[i], accel});
      const Eigen::Matrix4d& P = ekf.covariance();
      const double size = P.norm();
      ASSERT_LT((P - P.transpose()).norm(), 1e-12 * size);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(P, Eigen::EigenvaluesOnly);
      ASSERT_GT(solver.eigenvalues().minCoeff(), -1e-12 * size) << i;
    }
  }
}

TEST(ThesisEkf, AccelerometerLeavesTheTurnWithinAReadoutAlone) {
  const auto gyro = read_gyro_log();
  std::ifstream file(log_path("accel.csv"));
  if (gyro.empty()) GTEST_SKIP() << "needs data/logs/iphone-handheld of the shared recordings";
  ImuAligner aligner(Accelerometer::present);
  for (const auto& sample : gyro) {
    double t = -1, x = 0, y = 0, z = 0;
    for (std::string line;
         SensorTime(time_from_seconds(t)) < sample.time && std::getline(file, line);) {
      if (std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &t, &x, &y, &z) != 4) continue;
      aligner.push(AccelSample{time_from_seconds(t), {-x, -y, -z}});  // CoreMotion's sign
    }
    aligner.push(sample);
  }
  aligner.finish();
  ThesisEkf with_accel, gyro_only;
  std::vector<Eigen::Quaterniond> a, b;
  while (auto sample = aligner.pop()) {
    if (!a.empty() || sample->accel_m_s2) a.push_back(with_accel.update(*sample).q_world_imu);
    sample->accel_m_s2.reset();
    if (!a.empty()) b.push_back(gyro_only.update(*sample).q_world_imu);
  }
  ASSERT_EQ(a.size(), b.size());
  // What the accelerometer adds to the turn over 30 ms. Its mean makes good the gyroscope's bias.
  const std::size_t harsh = 2400;  // 24 s at 100 Hz
  std::vector<Eigen::Vector3d> added_deg;
  for (std::size_t i = harsh; i + 3 < a.size(); ++i) {
    Eigen::Quaterniond added =
        (b[i].conjugate() * b[i + 3]).conjugate() * (a[i].conjugate() * a[i + 3]);
    if (added.w() < 0) added.coeffs() *= -1;
    added_deg.emplace_back(2 * added.vec() / kDegree);
  }
  ASSERT_GT(added_deg.size(), 700U);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& v : added_deg) mean += v / static_cast<double>(added_deg.size());
  double squares = 0;
  for (const auto& v : added_deg) squares += (v - mean).squaredNorm();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(added_deg.size())), 0.02);
}

TEST(ThesisEkf, SamplesThatCannotBeUsedAreSkippedAndCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d rate(0.1, 0.2, -0.3);
  const Eigen::Vector3d gravity(0, 0, 9.80665);
  ThesisEkf clean, dirty;
  const auto sample_at = [&](int ms) {
    return ImuSample{SensorTime(milliseconds(ms)), rate, gravity};
  };
  for (int ms = 0; ms < 1000; ms += 10) {
    for (double bad : {nan, infinity, -infinity, 1e300}) {
      ImuSample bad_gyro = sample_at(ms + 5);
      bad_gyro.gyro_rad_s.y() = bad;
      dirty.update(sample_at(ms));
      const auto answer = dirty.update(bad_gyro);
      EXPECT_EQ(answer.time, bad_gyro.time);
      EXPECT_NEAR(answer.q_world_imu.norm(), 1, 1e-12);
    }
    clean.update(sample_at(ms));
  }
  // The first of each four was good, the others were not later; so three are skipped beside the
  // bad.
  EXPECT_EQ(dirty.counts().skipped_gyro, 100U * (4 + 3));
  EXPECT_EQ(dirty.update(sample_at(1000)).q_world_imu, clean.update(sample_at(1000)).q_world_imu);
}

TEST(ThesisEkf, AccelerationThatCannotBeUsedIsNone) {
  const Eigen::Vector3d rate(0.1, 0.2, -0.3);
  const Eigen::Vector3d gravity(0, 0, 9.80665);
  for (double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    ThesisEkf clean, dirty;
    for (ThesisEkf* ekf : {&clean, &dirty}) ekf->update({SensorTime(), rate, gravity});
    clean.update({SensorTime(milliseconds(10)), rate, std::nullopt});
    dirty.update({SensorTime(milliseconds(10)), rate, Eigen::Vector3d(0, bad, 0)});
    EXPECT_EQ(dirty.counts().skipped_accel, 1U);
    const ImuSample good{SensorTime(milliseconds(20)), rate, gravity};
    EXPECT_EQ(dirty.update(good).q_world_imu, clean.update(good).q_world_imu);
  }
}

TEST(ThesisEkf, FreeFallHasNoDirectionToStartFrom) {
  ThesisEkf ekf;
  ekf.update({SensorTime(), Eigen::Vector3d::Zero(), Eigen::Vector3d(0.01, 0, 0)});
  const auto attitude = ekf.update(
      {SensorTime(milliseconds(10)), Eigen::Vector3d::Zero(), Eigen::Vector3d(9.8, 0, 0)});
  EXPECT_NEAR((attitude.q_world_imu * Eigen::Vector3d::UnitX()).z(), 1, 1e-12);
}

TEST(ThesisEkf, BridgesAShortPauseAndHoldsOverALongOne) {
  const Eigen::Vector3d rate(0, 0, 0.5);
  ThesisEkf ekf;
  ekf.update({SensorTime(), rate, std::nullopt});
  auto attitude = ekf.update({SensorTime(milliseconds(235)), rate, std::nullopt});
  EXPECT_LT(degrees_between(attitude.q_world_imu, turn(0.5 * 0.235, {0, 0, 1})), 1e-9);
  EXPECT_EQ(ekf.counts().gaps, 0U);
  const auto held = attitude.q_world_imu;
  attitude = ekf.update({SensorTime(milliseconds(2235)), rate, std::nullopt});
  EXPECT_EQ(attitude.q_world_imu, held);
  EXPECT_EQ(ekf.counts().gaps, 1U);
}

}  // namespace
}  // namespace gimbal

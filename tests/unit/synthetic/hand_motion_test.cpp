#include "drivers/synthetic/hand_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace gimbal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Power of a signal at one frequency (Goertzel's sum written out), sampled at `rate_hz`.
double power_at(const std::vector<double>& signal, double rate_hz, double frequency_hz) {
  double real = 0;
  double imaginary = 0;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    const double phase = 2.0 * std::numbers::pi * frequency_hz * static_cast<double>(i) / rate_hz;
    real += signal[i] * std::cos(phase);
    imaginary += signal[i] * std::sin(phase);
  }
  const auto count = static_cast<double>(signal.size());
  return (real * real + imaginary * imaginary) / (count * count);
}

std::vector<double> pitch_rates(const Motion& motion, SensorDuration duration) {
  std::vector<double> rates;
  for (SensorTime t; t < SensorTime(duration); t += milliseconds(10)) {
    rates.push_back(motion.at(t).rate_rad_s.x());
  }
  return rates;
}

double band_power(const std::vector<double>& signal, double low_hz, double high_hz) {
  double sum = 0;
  for (double f = low_hz; f < high_hz; f += 0.05) sum += power_at(signal, 100.0, f);
  return sum;
}

TEST(HandMotion, WalkingPitchesWithTheStep) {
  const std::vector<double> rates =
      pitch_rates(make_hand_motion(walking_hand(), seconds(20), 5), seconds(20));
  const double step = band_power(rates, 1.8, 2.0);
  EXPECT_GT(step, 10.0 * band_power(rates, 1.3, 1.5));
  EXPECT_GT(step, 10.0 * band_power(rates, 2.4, 2.6));
}

TEST(HandMotion, TremorLiesBetween6And12Hz) {
  HandModel model;
  model.rotation_rad = {{6.0, 12.0, Eigen::Vector3d::Constant(0.001)}};
  const std::vector<double> rates =
      pitch_rates(make_hand_motion(model, seconds(20), 6), seconds(20));
  EXPECT_GT(band_power(rates, 5.9, 12.1), 100.0 * band_power(rates, 0.1, 5.5));
  EXPECT_GT(band_power(rates, 5.9, 12.1), 100.0 * band_power(rates, 12.5, 30.0));
}

TEST(HandMotion, PanTurnsByItsAngleAndRests) {
  HandModel model;
  model.pan = {1.0, seconds(2), seconds(1)};
  const Motion motion = make_hand_motion(model, seconds(8), 7);
  const auto angle_from_start = [&](double t_s) {
    return motion.at(SensorTime())
        .q_world_camera.angularDistance(motion.at(time_from_seconds(t_s)).q_world_camera);
  };
  EXPECT_NEAR(angle_from_start(0.9), 0.0, 1e-6);
  EXPECT_NEAR(angle_from_start(2.0), 0.5, 1e-3);
  EXPECT_NEAR(angle_from_start(3.5), 1.0, 1e-3);
  EXPECT_NEAR(angle_from_start(6.5), 0.0, 1e-3);
  // A raised cosine peaks at twice the mean rate. Heading left is a negative yaw (camera y is
  // down).
  EXPECT_NEAR(motion.at(time_from_seconds(2.0)).rate_rad_s.y(), -1.0, 1e-2);
}

TEST(HandMotion, AccelerationIsThatOfAPointOnALever) {
  HandModel model;
  model.rotation_rad = {{0.5, 3.0, Eigen::Vector3d(0.1, 0.15, 0.1)}};
  model.lever_camera_m = {0.05, -0.1, 0.4};
  const Motion motion = make_hand_motion(model, seconds(3), 8);
  const auto place = [&](SensorTime t) {
    return Eigen::Vector3d(motion.at(t).q_world_camera * model.lever_camera_m);
  };
  constexpr milliseconds kStep(1);
  for (SensorTime t = SensorTime(milliseconds(100)); t < SensorTime(seconds(3)) - kStep;
       t += milliseconds(37)) {
    const Eigen::Vector3d difference =
        (place(t + kStep) - 2.0 * place(t) + place(t - kStep)) / 1e-6;
    EXPECT_LT((motion.at(t).acceleration_m_s2 - difference).norm(),
              0.02 * difference.norm() + 0.02);
  }
}

TEST(HandMotion, TripodStandsStillAndLevel) {
  const Motion motion = make_hand_motion(tripod(), seconds(2), 9);
  for (SensorTime t; t < SensorTime(seconds(2)); t += milliseconds(111)) {
    EXPECT_LT(motion.at(t).rate_rad_s.norm(), 1e-12);
    const Eigen::Vector3d right = motion.at(t).q_world_camera * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d forward = motion.at(t).q_world_camera * Eigen::Vector3d::UnitZ();
    EXPECT_LT((right - Eigen::Vector3d(0, -1, 0)).norm(), 1e-9);
    EXPECT_LT((forward - Eigen::Vector3d(1, 0, 0)).norm(), 1e-9);
  }
}

TEST(HandMotion, SeedDecides) {
  const auto rate = [](std::uint64_t seed) {
    return make_hand_motion(walking_hand(), seconds(1), seed)
        .at(SensorTime(milliseconds(500)))
        .rate_rad_s;
  };
  EXPECT_EQ(rate(1), rate(1));
  EXPECT_GT((rate(1) - rate(2)).norm(), 1e-3);
}

TEST(HandMotion, EachModelShakesAsHandsDo) {
  struct Case {
    HandModel model;
    double least_rms_rad_s, most_rms_rad_s;
  };
  for (const Case& c : {Case{walking_hand(), 0.1, 0.6}, Case{running_hand(), 0.5, 2.0},
                        Case{panning_hand(), 0.2, 1.0}, Case{vehicle_mount(), 0.03, 0.5}}) {
    const Motion motion = make_hand_motion(c.model, seconds(10), 10);
    double squares = 0;
    int count = 0;
    for (SensorTime t; t < SensorTime(seconds(10)); t += milliseconds(7), ++count) {
      squares += motion.at(t).rate_rad_s.squaredNorm();
    }
    EXPECT_GT(std::sqrt(squares / count), c.least_rms_rad_s);
    EXPECT_LT(std::sqrt(squares / count), c.most_rms_rad_s);
  }
}

}  // namespace
}  // namespace gimbal

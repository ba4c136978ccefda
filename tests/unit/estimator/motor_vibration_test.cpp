#include "pipeline/estimator/motor_vibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

namespace gimbal {
namespace {

struct Motion {
  double turn_rad_s;      ///< amplitude, at 0.7 Hz
  double push_m_s2;       ///< amplitude, at 2 Hz
  double vibration_m_s2;  ///< amplitude, at 136 Hz
};

/// After three seconds at the rate.
double machine_share(const Motion& motion, double rate_hz) {
  MotorVibration vibration{MotorVibrationParameters{}};
  for (int i = 0; i < 3 * rate_hz; ++i) {
    const double t = i / rate_hz;
    const auto wave = [t](double hz) { return std::sin(2 * std::numbers::pi * hz * t); };
    const Eigen::Vector3d force(motion.push_m_s2 * wave(2), 0.5 * motion.vibration_m_s2 * wave(136),
                                9.81 + motion.vibration_m_s2 * wave(136));
    vibration.add({0, motion.turn_rad_s * wave(0.7), 0}, force, 1 / rate_hz);
  }
  return vibration.machine_share();
}

TEST(MotorVibration, KnowsAMachineFromAHand) {
  for (const double rate_hz : {100.0, 200.0, 286.0, 500.0}) {
    SCOPED_TRACE(rate_hz);
    EXPECT_GT(machine_share({0.3, 4, 10}, rate_hz), 0.8);
    EXPECT_LT(machine_share({0.3, 4, 0}, rate_hz), 0.02);
    EXPECT_LT(machine_share({2, 20, 0}, rate_hz), 0.25);  // shaken by hand
    EXPECT_LT(machine_share({5, 4, 10}, rate_hz), 0.1);   // a hand that holds what vibrates
  }
}

TEST(MotorVibration, SaysNothingWithoutForces) {
  MotorVibration vibration{MotorVibrationParameters{}};
  for (int i = 0; i < 1000; ++i) {
    // One now and then shows no vibration: what lies between is not known.
    std::optional<Eigen::Vector3d> force;
    if (i % 3 != 0) force.emplace(0, 0, i % 2 != 0 ? 20 : 0);
    vibration.add({0.1, 0, 0}, force, 0.005);
  }
  EXPECT_EQ(vibration.machine_share(), 0);
}

}  // namespace
}  // namespace gimbal

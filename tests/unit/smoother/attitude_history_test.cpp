#include "pipeline/smoother/attitude_history.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace gimbal {
namespace {

using std::chrono::milliseconds;

Eigen::Quaterniond turn_z(double angle_rad) {
  return {std::cos(angle_rad / 2), 0, 0, std::sin(angle_rad / 2)};
}

/// Turns about z at 1 rad/s, an attitude every 10 ms from 100 ms to 200 ms.
AttitudeHistory steady_turn() {
  AttitudeHistory history(milliseconds(50));
  for (int ms = 100; ms <= 200; ms += 10) {
    EXPECT_TRUE(history.append({SensorTime(milliseconds(ms)), turn_z(ms * 1e-3)}));
  }
  return history;
}

TEST(AttitudeHistory, AnswersExactlyAtAnEstimate) {
  const auto answer = steady_turn().at(SensorTime(milliseconds(130)));
  EXPECT_EQ(answer.origin, AttitudeOrigin::exact);
  EXPECT_NEAR(answer.q_world_imu.angularDistance(turn_z(0.130)), 0, 1e-12);
}

TEST(AttitudeHistory, FollowsASteadyTurnBetweenEstimates) {
  const AttitudeHistory history = steady_turn();
  for (double seconds : {0.1001, 0.1349, 0.1555, 0.1999}) {
    const auto answer = history.at(time_from_seconds(seconds));
    EXPECT_EQ(answer.origin, AttitudeOrigin::interpolated) << seconds;
    EXPECT_NEAR(answer.q_world_imu.angularDistance(turn_z(seconds)), 0, 1e-9) << seconds;
  }
}

TEST(AttitudeHistory, ForgetsNothingThatALaterAnswerNeeds) {
  const AttitudeHistory whole = steady_turn();
  AttitudeHistory shorter = steady_turn();
  shorter.forget_before(time_from_seconds(0.155));
  EXPECT_EQ(shorter.attitudes().size(), 6U);  // 150 to 200 ms
  for (const double seconds : {0.155, 0.16, 0.19}) {
    const SensorTime time = time_from_seconds(seconds);
    EXPECT_EQ(shorter.at(time).q_world_imu.coeffs(), whole.at(time).q_world_imu.coeffs());
  }
  shorter.forget_before(time_from_seconds(9));
  EXPECT_EQ(shorter.attitudes().size(), 1U);  // the last one answers for what follows
}

TEST(AttitudeHistory, TakesTheShortWayBetweenOppositeSigns) {
  AttitudeHistory history(milliseconds(50));
  Eigen::Quaterniond opposite = turn_z(0.2);
  opposite.coeffs() = -opposite.coeffs();
  history.append({SensorTime(milliseconds(0)), turn_z(0)});
  history.append({SensorTime(milliseconds(10)), opposite});
  const auto answer = history.at(SensorTime(milliseconds(5)));
  EXPECT_NEAR(answer.q_world_imu.angularDistance(turn_z(0.1)), 0, 1e-12);
}

TEST(AttitudeHistory, HoldsTheEndsAndSaysSo) {
  const AttitudeHistory history = steady_turn();
  const auto before = history.at(SensorTime(milliseconds(20)));
  EXPECT_EQ(before.origin, AttitudeOrigin::predicted);
  EXPECT_NEAR(before.q_world_imu.angularDistance(turn_z(0.1)), 0, 1e-12);
  const auto after = history.at(SensorTime(milliseconds(900)));
  EXPECT_EQ(after.origin, AttitudeOrigin::predicted);
  EXPECT_NEAR(after.q_world_imu.angularDistance(turn_z(0.2)), 0, 1e-12);
}

TEST(AttitudeHistory, DoesNotTrustAGap) {
  AttitudeHistory history(milliseconds(50));
  history.append({SensorTime(milliseconds(0)), turn_z(0)});
  history.append({SensorTime(milliseconds(50)), turn_z(0.05)});
  history.append({SensorTime(milliseconds(101)), turn_z(0.101)});
  EXPECT_EQ(history.at(SensorTime(milliseconds(25))).origin, AttitudeOrigin::interpolated);
  EXPECT_EQ(history.at(SensorTime(milliseconds(75))).origin, AttitudeOrigin::predicted);
}

TEST(AttitudeHistory, RefusesWhatIsNotLater) {
  AttitudeHistory history(milliseconds(50));
  EXPECT_TRUE(history.append({SensorTime(milliseconds(10)), turn_z(0.1)}));
  EXPECT_FALSE(history.append({SensorTime(milliseconds(10)), turn_z(0.2)}));
  EXPECT_FALSE(history.append({SensorTime(milliseconds(9)), turn_z(0.2)}));
  EXPECT_EQ(history.attitudes().size(), 1U);
}

}  // namespace
}  // namespace gimbal

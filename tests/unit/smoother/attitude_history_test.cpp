#include "pipeline/smoother/attitude_history.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

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
    EXPECT_TRUE(history.append({{SensorTime(milliseconds(ms)), turn_z(ms * 1e-3)}}));
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
  EXPECT_EQ(shorter.size(), 6U);  // 150 to 200 ms
  for (const double seconds : {0.155, 0.16, 0.19}) {
    const SensorTime time = time_from_seconds(seconds);
    EXPECT_EQ(shorter.at(time).q_world_imu.coeffs(), whole.at(time).q_world_imu.coeffs());
  }
  shorter.forget_before(time_from_seconds(9));
  EXPECT_EQ(shorter.size(), 1U);  // the last one answers for what follows
}

TEST(AttitudeHistory, TakesTheShortWayBetweenOppositeSigns) {
  AttitudeHistory history(milliseconds(50));
  Eigen::Quaterniond opposite = turn_z(0.2);
  opposite.coeffs() = -opposite.coeffs();
  history.append({{SensorTime(milliseconds(0)), turn_z(0)}});
  history.append({{SensorTime(milliseconds(10)), opposite}});
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
  history.append({{SensorTime(milliseconds(0)), turn_z(0)}});
  history.append({{SensorTime(milliseconds(50)), turn_z(0.05)}});
  history.append({{SensorTime(milliseconds(101)), turn_z(0.101)}});
  EXPECT_EQ(history.at(SensorTime(milliseconds(25))).origin, AttitudeOrigin::interpolated);
  EXPECT_EQ(history.at(SensorTime(milliseconds(75))).origin, AttitudeOrigin::predicted);
}

TEST(AttitudeHistory, RefusesWhatIsNotLater) {
  AttitudeHistory history(milliseconds(50));
  EXPECT_TRUE(history.append({{SensorTime(milliseconds(10)), turn_z(0.1)}}));
  EXPECT_FALSE(history.append({{SensorTime(milliseconds(10)), turn_z(0.2)}}));
  EXPECT_FALSE(history.append({{SensorTime(milliseconds(9)), turn_z(0.2)}}));
  EXPECT_EQ(history.size(), 1U);
}

TEST(AttitudeHistory, AnEstimateKeepsItsCovarianceAndItsOrigin) {
  AttitudeHistory history(milliseconds(50));
  const Eigen::Matrix3d covariance = Eigen::Vector3d(1e-4, 2e-4, 3e-4).asDiagonal();
  history.append({{SensorTime(milliseconds(10)), turn_z(0)}, covariance, AttitudeOrigin::exact});
  history.append(
      {{SensorTime(milliseconds(20)), turn_z(0)}, 3 * covariance, AttitudeOrigin::predicted});
  EXPECT_EQ(history.at(SensorTime(milliseconds(10))).covariance_rad2, covariance);
  EXPECT_EQ(history.at(SensorTime(milliseconds(20))).origin, AttitudeOrigin::predicted);
  const auto between = history.at(SensorTime(milliseconds(15)));
  EXPECT_EQ(between.origin, AttitudeOrigin::predicted);
  EXPECT_LT((between.covariance_rad2 - 2 * covariance).norm(), 1e-12);  // never turned: no bend
}

TEST(AttitudeHistory, TheCovarianceAwayFromEstimatesIsThatOfARateThatWalks) {
  // About z alone, every 10 ms, by a rate that walks; judged over many walks.
  constexpr double kWalk_rad2_s3 = 3;
  constexpr double kFine_s = 1e-3;
  struct Judged {
    SensorTime time;
    double square = 0;
    double variance = 0;
  };
  Judged between{time_from_seconds(0.995)};
  Judged gap{time_from_seconds(1.1)};
  Judged after{time_from_seconds(1.25)};
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int walk = 0; walk < 2000; ++walk) {
    AttitudeHistory history(milliseconds(50));
    std::vector<double> angles{0};
    double rate = 0;
    for (int ms = 1; ms <= 1250; ++ms) {
      rate += std::sqrt(kWalk_rad2_s3 * kFine_s) * normal(random);
      angles.push_back(angles.back() + rate * kFine_s);
      const bool is_seen = ms % 10 == 0 && (ms <= 1000 || ms == 1200);
      if (is_seen) history.append({{SensorTime(milliseconds(ms)), turn_z(angles.back())}});
    }
    for (Judged* judged : {&between, &gap, &after}) {
      const auto answer = history.at(judged->time);
      const double truth = angles[static_cast<std::size_t>(
          std::lround(seconds_since_epoch(judged->time) / kFine_s))];
      const Eigen::Quaterniond error = turn_z(truth) * answer.q_world_imu.conjugate();
      const double angle = 2 * std::atan2(error.z(), error.w());
      judged->square +=
          std::remainder(angle, 2 * std::numbers::pi) * std::remainder(angle, 2 * std::numbers::pi);
      // Only one axis walks, of which each axis' covariance has a third.
      judged->variance += 3 * answer.covariance_rad2(0, 0);
      if (judged == &after) {
        judged->variance += answer.covariance_rad2(2, 2) - answer.covariance_rad2(0, 0);
      }
    }
  }
  EXPECT_NEAR(between.square / between.variance, 1, 0.25);
  EXPECT_NEAR(gap.square / gap.variance, 1, 0.25);
  EXPECT_NEAR(after.square / after.variance, 1, 0.25);
}

}  // namespace
}  // namespace gimbal

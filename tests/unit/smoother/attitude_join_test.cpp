#include "pipeline/smoother/attitude_join.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace gimbal {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

double tilt_between(const Quaterniond& a, const Quaterniond& b) {
  const Vector3d up_a = a.conjugate() * Vector3d::UnitZ();
  const Vector3d up_b = b.conjugate() * Vector3d::UnitZ();
  return std::atan2(up_a.cross(up_b).norm(), up_a.dot(up_b));
}

TEST(AttitudeJoin, ChangesNothingWithoutABreak) {
  AttitudeJoin join;
  const Quaterniond q(AngleAxisd(0.4, Vector3d(1, 2, 3).normalized()));
  EXPECT_LT(join.turned(Attitude{time_from_seconds(5), q}).q_world_imu.angularDistance(q), 1e-12);
}

TEST(AttitudeJoin, GoesOnFromWhatWasHeld) {
  AttitudeJoin join;
  const Quaterniond held(AngleAxisd(0.3, Vector3d(1, -1, 2).normalized()));
  const Quaterniond next(AngleAxisd(1.2, Vector3d(0, 1, 1).normalized()));
  join.join(held, {time_from_seconds(1), next});
  const Quaterniond turned = join.turned(Attitude{time_from_seconds(1), next}).q_world_imu;
  EXPECT_LT(turned.angularDistance(held), 1e-9);
}

TEST(AttitudeJoin, FindsUprightAgainAndKeepsTheTurnAboutTheVertical) {
  AttitudeJoin join;
  const Quaterniond next(AngleAxisd(0.7, Vector3d(0.2, 1, 0.1).normalized()));
  const Quaterniond turn =
      AngleAxisd(20 * kDegree, Vector3d::UnitX()) * AngleAxisd(90 * kDegree, Vector3d::UnitZ());
  join.join(turn * next, {time_from_seconds(0), next});
  Quaterniond before = turn * next;
  for (int i = 0; i <= 3000; ++i) {
    const double t_s = i / 100.0;
    const Quaterniond turned = join.turned(Attitude{time_from_seconds(t_s), next}).q_world_imu;
    EXPECT_LT(turned.angularDistance(before), 0.05 * kDegree) << "a jump at " << t_s << " s";
    before = turned;
  }
  EXPECT_LT(tilt_between(before, next), 1e-6);
  const Quaterniond expected = AngleAxisd(90 * kDegree, Vector3d::UnitZ()) * next;
  EXPECT_LT(before.angularDistance(expected), 1e-6);
}

TEST(AttitudeJoin, TheTiltThatStillFadesIsPartOfTheCovariance) {
  AttitudeJoin join;
  const SensorTime time = time_from_seconds(0);
  const Quaterniond next = Quaterniond::Identity();
  join.join(Quaterniond(AngleAxisd(20 * kDegree, Vector3d::UnitX())), {time, next});
  const AttitudeEstimate estimate{{time, next}, 1e-4 * Eigen::Matrix3d::Identity()};
  const auto sigma_x = [&](double t_s) {
    AttitudeEstimate later = estimate;
    later.attitude.time = time_from_seconds(t_s);
    return std::sqrt(join.turned(later).covariance_rad2(0, 0));
  };
  EXPECT_NEAR(sigma_x(0), std::hypot(20 * kDegree, 0.01), 1e-6);
  EXPECT_NEAR(sigma_x(5), std::hypot(10 * kDegree, 0.01), 1e-6);
  EXPECT_NEAR(sigma_x(20), 0.01, 1e-9);
}

}  // namespace
}  // namespace gimbal

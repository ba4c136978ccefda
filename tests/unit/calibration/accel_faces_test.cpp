#include "pipeline/calibration/accel_faces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

const Eigen::Vector3d kScale(1.02, 0.985, 1.004);
const Eigen::Vector3d kBias(0.3, -0.2, 0.12);

struct Log {
  std::vector<AccelSample> accel;
  std::vector<GyroSample> gyro;
};

/// Two seconds on each face, turned from one to the next within a second; faces lie a few degrees
/// askew.
Log laid_on(const std::vector<Eigen::Vector3d>& faces) {
  Random random(9);
  const auto noise = [&](double sigma) -> Eigen::Vector3d {
    return sigma * Eigen::Vector3d(random.normal(), random.normal(), random.normal());
  };
  Log log;
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const Eigen::Vector3d up = (faces[face] + noise(0.05)).normalized();
    for (int i = 0; i < 300; ++i) {
      const SensorTime time = time_from_seconds(3.0 * static_cast<double>(face) + 0.01 * i);
      const bool turns = i >= 200;
      const Eigen::Vector3d force = kStandardGravity_m_s2 * up + noise(turns ? 3 : 0.02);
      log.accel.push_back({time, kScale.cwiseProduct(force) + kBias});
      log.gyro.push_back({time, noise(0.001) + (turns ? Eigen::Vector3d(1, -1.5, 0.5)
                                                      : Eigen::Vector3d(0.01, 0, -0.02))});
    }
  }
  return log;
}

std::vector<Eigen::Vector3d> six_faces() {
  return {Eigen::Vector3d::UnitX(),  -Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY(),
          -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(),  -Eigen::Vector3d::UnitZ()};
}

TEST(AccelFaces, ShowScaleAndBias) {
  const Log log = laid_on(six_faces());
  const AccelErrors found = fit_accel_errors(log.accel, log.gyro);
  ASSERT_EQ(found.reason, "");
  EXPECT_EQ(found.poses, 6U);
  EXPECT_LT((found.scale - kScale).cwiseAbs().maxCoeff(), 0.001);
  EXPECT_LT((found.bias_m_s2 - kBias).cwiseAbs().maxCoeff(), 0.01);
}

TEST(AccelFaces, AreNamedWhenTheyAreMissing) {
  auto faces = six_faces();
  faces.erase(faces.begin() + 3);
  const Log log = laid_on(faces);
  EXPECT_THAT(fit_accel_errors(log.accel, log.gyro).reason, ::testing::EndsWith(": -y"));
}

TEST(AccelFaces, DisagreeWhenAScaleChangesWithTheSign) {
  Log log = laid_on(six_faces());
  for (const Eigen::Vector3d& tilted :
       {Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(-1, 1, 0), Eigen::Vector3d(0, 1, 1)}) {
    auto faces = six_faces();
    faces.push_back(tilted.normalized());
    log = laid_on(faces);
    for (AccelSample& sample : log.accel) {
      if (sample.accel_m_s2.y() > 5 && sample.accel_m_s2.y() < 8) sample.accel_m_s2.y() -= 1.5;
    }
    EXPECT_THAT(fit_accel_errors(log.accel, log.gyro).reason, ::testing::HasSubstr("disagree"));
  }
}

}  // namespace
}  // namespace gimbal

#include "pipeline/calibration/allan_deviation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/synthetic/random.hpp"

namespace gimbal {
namespace {

// The nine frequencies of the classic NBS test suite and their overlapping Allan deviations at one
// and two intervals, as published (Riley, Handbook of Frequency Stability Analysis, NIST SP 1065).
TEST(AllanDeviation, AgreesWithThePublishedTestSuite) {
  const std::vector<double> values = {892, 809, 823, 798, 671, 644, 883, 903, 677};
  const auto points = allan_deviation(values, 1);
  ASSERT_GE(points.size(), 2U);
  EXPECT_NEAR(points[0].deviation, 91.22945, 1e-5);
  EXPECT_NEAR(points[1].deviation, 85.95287, 1e-5);
}

TEST(AllanDeviation, OfWhiteNoiseFallsWithTheRootOfTau) {
  Random random(3);
  std::vector<double> values(100000);
  for (double& value : values) value = 0.7 * random.normal();
  for (const AllanPoint& point : allan_deviation(values, 0.01)) {
    if (point.tau_s > 10) continue;
    EXPECT_NEAR(point.deviation, 0.7 / std::sqrt(point.tau_s / 0.01), 0.1 * point.deviation);
  }
}

// Of a ramp that rises by r a second: r tau / sqrt(2).
TEST(AllanDeviation, OfADriftRisesWithTau) {
  std::vector<double> values(4000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.02 * static_cast<double>(i) * 0.1;
  const auto points = allan_deviation(values, 0.1);
  EXPECT_NEAR(points.back().deviation, 0.02 * points.back().tau_s / std::sqrt(2), 1e-9);
  EXPECT_GT(points.back().tau_s, 75);
  EXPECT_LE(points.back().tau_s, 100);
}

}  // namespace
}  // namespace gimbal

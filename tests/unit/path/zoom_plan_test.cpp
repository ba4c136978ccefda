#include "pipeline/path/zoom_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace gimbal {
namespace {

constexpr double kInterval_s = 1 / 30.0;

/// The zooms of a clip that needs `zoom` from 2 s to 3 s and none else, with so much of the future
/// known at each frame.
std::vector<double> breathe(double zoom, std::size_t known, ZoomChoice choice) {
  ZoomPlan plan(choice);
  std::vector<double> zooms;
  for (std::size_t i = 0; i < 300; ++i) {
    std::vector<ZoomNeed> needs;
    for (std::size_t j = i; j <= i + known; ++j) {
      const double t_s = static_cast<double>(j) * kInterval_s;
      needs.push_back({t_s, t_s >= 2 && t_s < 3 ? zoom : 1});
    }
    zooms.push_back(plan.plan(needs).front());
  }
  return zooms;
}

TEST(ZoomPlan, AFixedZoomIsKept) {
  for (const double zoom : breathe(1.4, 5, {1.2, 1.2})) EXPECT_EQ(zoom, 1.2);
}

TEST(ZoomPlan, IsThereInTimeWhenItKnows) {
  const auto zooms = breathe(1.1, 60, {1, 1.25});
  EXPECT_EQ(zooms.front(), 1);
  for (std::size_t i = 61; i < 89; ++i) EXPECT_NEAR(zooms[i], 1.1, 1e-9) << i;
}

TEST(ZoomPlan, NeverChangesFast) {
  for (const std::size_t known : {0U, 5U, 60U}) {
    const auto zooms = breathe(1.2, known, {1, 1.25});
    for (std::size_t i = 1; i < zooms.size(); ++i) {
      EXPECT_LT(zooms[i] - zooms[i - 1], 0.1 * kInterval_s) << i;
      EXPECT_GT(zooms[i] - zooms[i - 1], -0.05 * kInterval_s) << i;
    }
  }
}

TEST(ZoomPlan, KeepsToItsLimits) {
  for (const double zoom : breathe(7, 60, {1.05, 1.25})) {
    EXPECT_GE(zoom, 1.05);
    EXPECT_LE(zoom, 1.25);
  }
}

TEST(ZoomPlan, KeepsToItsSpeedInEveryFrame) {
  for (const double speed_per_s : {0.01, 0.5}) {
    for (const std::size_t known : {0U, 5U, 60U}) {
      const auto zooms = breathe(3, known, {1, 2, speed_per_s});
      double fastest_per_s = 0;
      for (std::size_t i = 1; i < zooms.size(); ++i) {
        fastest_per_s = std::max(fastest_per_s, (zooms[i] - zooms[i - 1]) / kInterval_s);
        EXPECT_GT((zooms[i] - zooms[i - 1]) / kInterval_s, -speed_per_s) << i;
      }
      EXPECT_NEAR(fastest_per_s, speed_per_s, 1e-6);  // and uses it
    }
  }
}

TEST(ZoomPlan, GoesBackWhenItIsNotNeededAnyMore) {
  const auto zooms = breathe(1.1, 60, {1, 1.25});
  EXPECT_EQ(zooms.back(), 1);
}

}  // namespace
}  // namespace gimbal

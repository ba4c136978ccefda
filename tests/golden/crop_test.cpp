// With the border cropped no written pixel may lack a source: a minute of the harshest motions for
// each zoom and latency, with a rolling shutter of 30 ms.

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "drivers/synthetic/hand_motion.hpp"
#include "pipeline/path/camera_path.hpp"
#include "pipeline/stabilizer.hpp"
#include "tests/golden/ipod_in_hand.hpp"
#include "tests/support/truth_estimator.hpp"

namespace gimbal {
namespace {

constexpr int kSeconds = 12;
constexpr int kSamplesPerSecond = 500;
constexpr double kFps = 30;

/// Thrown about: faster than a readout can follow.
HandModel thrown() {
  HandModel hand;
  hand.rotation_rad = {{0.5, 3, 0.3 * Eigen::Vector3d::Ones()},
                       {5, 12, 0.05 * Eigen::Vector3d::Ones()}};
  return hand;
}

std::vector<Motion> harshest_motions(std::uint64_t seed) {
  const SensorDuration duration = std::chrono::seconds(kSeconds);
  return {make_hand_motion(running_hand(), duration, seed),
          make_hand_motion(vehicle_mount(), duration, seed),
          make_hand_motion(thrown(), duration, seed), test::hand_motion(20, kSeconds),
          make_hand_motion(panning_hand(), duration, seed)};
}

struct Outcome {
  std::int64_t frames = 0;
  std::int64_t border_px = 0;
  std::int64_t rectified_in_part = 0;
};

Outcome run(const Motion& motion, const CameraCalibration& camera, double zoom,
            PathLatency latency) {
  const ImuCalibration imu = test::phone_axes();
  auto stabilizer = *Stabilizer::create(
      camera, imu, make_causal_stream(std::make_unique<test::TruthEstimator>(motion, imu)),
      make_bounded_path({}, {zoom, zoom}, latency), {});
  for (int i = -100; i < (kSeconds + 1) * kSamplesPerSecond; ++i) {
    stabilizer.push(ImuSample{time_from_seconds(static_cast<double>(i) / kSamplesPerSecond),
                              Eigen::Vector3d::Zero(), std::nullopt});
  }
  for (int i = 0; i < kSeconds * static_cast<int>(kFps); ++i) {
    stabilizer.push(FrameStamp{i, time_from_seconds(i / kFps), std::nullopt});
  }
  stabilizer.finish();
  Outcome outcome;
  while (const auto view = stabilizer.next_camera()) {
    outcome.frames += 1;
    outcome.border_px += count_border_pixels(stabilizer.mesh_for(*view));
    if (view->rectified < 1) outcome.rectified_in_part += 1;
    EXPECT_NEAR(view->intrinsics.fx / stabilizer.unzoomed().fx, zoom, 1e-9);
  }
  return outcome;
}

using ZoomAndLatency = std::tuple<double, PathLatency>;

class CroppedBorder : public ::testing::TestWithParam<ZoomAndLatency> {};

TEST_P(CroppedBorder, IsNeverShown) {
  const auto [zoom, latency] = GetParam();
  for (const Motion& motion : harshest_motions(7)) {
    const Outcome outcome = run(motion, test::ipod_touch(), zoom, latency);
    EXPECT_EQ(outcome.frames, kSeconds * kFps);
    EXPECT_EQ(outcome.border_px, 0);
  }
}

std::string name_of(const ::testing::TestParamInfo<ZoomAndLatency>& info) {
  const auto [zoom, latency] = info.param;
  return "zoom_" + std::to_string(static_cast<int>(100 * zoom + 0.5)) + "_latency_" +
         (latency ? std::to_string(*latency) : "full");
}

INSTANTIATE_TEST_SUITE_P(Harshest, CroppedBorder,
                         ::testing::Combine(::testing::Values(1.1, 1.15, 1.25),
                                            ::testing::Values(PathLatency{0}, PathLatency{5},
                                                              PathLatency{15}, PathLatency{})),
                         name_of);

TEST(PartlyRectified, OnlyFramesThatNoViewFits) {
  // A walk's shear is far less than the room at this zoom.
  const Motion motion = make_hand_motion(walking_hand(), std::chrono::seconds(kSeconds), 3);
  const Outcome outcome = run(motion, test::ipod_touch(), 1.15, 5);
  EXPECT_EQ(outcome.border_px, 0);
  EXPECT_EQ(outcome.rectified_in_part, 0);
}

}  // namespace
}  // namespace gimbal

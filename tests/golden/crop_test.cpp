// With the border cropped no written pixel may lack a source: a minute of the harshest motions for
// each zoom and latency, with a rolling shutter of 30 ms.

#include <gtest/gtest.h>

#include <initializer_list>
#include <memory>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "drivers/synthetic/hand_motion.hpp"
#include "pipeline/path/camera_path.hpp"
#include "pipeline/path/steadiness.hpp"
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
  double shake_before_rad_s = 0;
  double shake_rad_s = 0;
  double fast_shake_before_rad_s = 0;
  double fast_shake_rad_s = 0;
};

Outcome run(const Motion& motion, const CameraCalibration& camera, double zoom, PathLatency latency,
            const StabilizerOptions& options = {}) {
  const ImuCalibration imu = test::phone_axes();
  auto stabilizer = *Stabilizer::create(
      camera, imu, make_causal_stream(std::make_unique<test::TruthEstimator>(motion, imu)),
      make_bounded_path({}, {zoom, zoom}, latency), options);
  for (int i = -100; i < (kSeconds + 1) * kSamplesPerSecond; ++i) {
    stabilizer.push(ImuSample{time_from_seconds(static_cast<double>(i) / kSamplesPerSecond),
                              Eigen::Vector3d::Zero(), std::nullopt});
  }
  for (int i = 0; i < kSeconds * static_cast<int>(kFps); ++i) {
    stabilizer.push(FrameStamp{i, time_from_seconds(i / kFps), std::nullopt});
  }
  stabilizer.finish();
  Outcome outcome;
  std::vector<FramePose> real;
  std::vector<FramePose> steady;
  while (const auto view = stabilizer.next_camera()) {
    real.push_back(stabilizer.real_pose(view->stamp));
    steady.push_back({view->stamp, view->q_world_camera});
    outcome.frames += 1;
    outcome.border_px += count_border_pixels(stabilizer.mesh_for(*view));
    if (view->rectified < 1) outcome.rectified_in_part += 1;
    EXPECT_NEAR(view->intrinsics.fx / stabilizer.unzoomed().fx, zoom, 1e-9);
  }
  outcome.shake_before_rad_s = rms_rate_above_rad_s(real, 1);
  outcome.shake_rad_s = rms_rate_above_rad_s(steady, 1);
  outcome.fast_shake_before_rad_s = rms_rate_above_rad_s(real, 4);
  outcome.fast_shake_rad_s = rms_rate_above_rad_s(steady, 4);
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

/// A camera, a hand, a zoom and a latency that somebody may well have.
class AnyCamera : public ::testing::TestWithParam<std::uint32_t> {
 protected:
  double between(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }

  template <typename Value>
  Value one_of(std::initializer_list<Value> values) {
    return *(values.begin() + std::uniform_int_distribution<std::ptrdiff_t>(
                                  0, static_cast<std::ptrdiff_t>(values.size()) - 1)(random_));
  }

  CameraCalibration camera() {
    CameraCalibration camera;
    camera.size = {640, 2 * static_cast<int>(between(170, 240))};
    camera.fps = kFps;
    camera.readout = duration_from_seconds(between(0, 0.03));
    camera.readout_direction = one_of({ReadoutDirection::top_down, ReadoutDirection::bottom_up,
                                       ReadoutDirection::left_right, ReadoutDirection::right_left});
    camera.lens.model = one_of({LensModel::pinhole, LensModel::brown, LensModel::fisheye});
    const double focal_px = between(camera.lens.model == LensModel::fisheye ? 260 : 450, 700);
    camera.lens.K << focal_px, 0, 320 + between(-8, 8), 0, focal_px,
        camera.size.height / 2.0 + between(-8, 8), 0, 0, 1;
    if (camera.lens.model == LensModel::brown) {
      camera.lens.distortion = {between(-0.15, 0.05), 0, 0.001, -0.001};
    }
    if (camera.lens.model == LensModel::fisheye) {
      camera.lens.distortion = {between(-0.03, 0.03), 0, 0, 0};
    }
    return camera;
  }

  Eigen::Vector3d up_to(double most_rad) {
    return {between(0, most_rad), between(0, most_rad), between(0, most_rad)};
  }

  HandModel hand() {
    HandModel hand;
    hand.rotation_rad = {{0.1, 1, up_to(0.15)}, {1, 4, up_to(0.05)}, {5, 20, up_to(0.02)}};
    return hand;
  }

  std::mt19937 random_{GetParam()};
};

INSTANTIATE_TEST_SUITE_P(Seed, AnyCamera, ::testing::Range(1U, 17U));

TEST_P(AnyCamera, ShowsNoBorderAndShakesLess) {
  const CameraCalibration camera = this->camera();
  StabilizerOptions options;
  options.output_lens = one_of({OutputLens::rectilinear, OutputLens::kept});
  const PathLatency latency = one_of({PathLatency{0}, PathLatency{5}, PathLatency{}});
  const double zoom = between(1.08, 1.3);
  const Motion motion = make_hand_motion(hand(), std::chrono::seconds(kSeconds), GetParam());
  const Outcome outcome = run(motion, camera, zoom, latency, options);
  EXPECT_EQ(outcome.frames, kSeconds * kFps);
  EXPECT_EQ(outcome.border_px, 0) << "zoom " << zoom << ", lens model "
                                  << static_cast<int>(camera.lens.model);
  EXPECT_LT(outcome.shake_rad_s, 0.9 * outcome.shake_before_rad_s);
}

TEST(CroppedPath, GivesWayWithoutKinks) {
  // A real hand that looks up and down by far more than the frames have room for.
  const Outcome outcome =
      run(test::hand_motion(0, kSeconds), test::ipod_touch(), 1.25, std::nullopt);
  EXPECT_LT(outcome.fast_shake_rad_s, 0.2 * outcome.fast_shake_before_rad_s);
}

TEST(PartlyRectified, OnlyFramesThatNoViewFits) {
  // A walk's shear is far less than the room at this zoom.
  const Motion motion = make_hand_motion(walking_hand(), std::chrono::seconds(kSeconds), 3);
  const Outcome outcome = run(motion, test::ipod_touch(), 1.15, 5);
  EXPECT_EQ(outcome.border_px, 0);
  EXPECT_EQ(outcome.rectified_in_part, 0);
}

}  // namespace
}  // namespace gimbal

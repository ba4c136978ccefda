// What only a live camera needs of the stabilizer: an IMU or a camera that goes away, and choices
// that change on the way.

#include "pipeline/stabilizer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kFps = 30;
constexpr double kImuRate = 240;  // Hz; whole samples a frame
constexpr int kWindow = 29;
constexpr std::size_t kLatency = 5;
constexpr double kDegree = std::numbers::pi / 180;

/// Turns left and right by some degrees, once a second.
Vector3d hand_rate_rad_s(double t_s) {
  return {0, 30 * kDegree * std::cos(2 * std::numbers::pi * t_s), 0};
}

class LiveStabilizer : public ::testing::Test {
 protected:
  static std::unique_ptr<CameraPath> path() { return make_hann_path(kWindow, {}, kLatency); }

  static StabilizerOptions options() {
    StabilizerOptions options;
    options.border = Border::black;  // any view will do, so the path alone is seen
    return options;
  }

  static Stabilizer make() {
    CameraCalibration camera;
    camera.size = {640, 480};
    camera.fps = kFps;
    camera.lens.K << 600, 0, 319.5, 0, 600, 239.5, 0, 0, 1;
    camera.readout = std::chrono::milliseconds(20);
    auto stabilizer = Stabilizer::create(
        camera, ImuCalibration{}, make_causal_stream(AttitudeEkfParameters{}), path(), options());
    return std::move(*stabilizer);
  }

  void imu_runs(double from_s, double to_s) {
    const int samples = static_cast<int>(std::lround((to_s - from_s) * kImuRate));
    for (int i = 0; i < samples; ++i) {
      const double t_s = from_s + i / kImuRate;
      stabilizer_.push(
          ImuSample{time_from_seconds(t_s), hand_rate_rad_s(t_s), Vector3d(0, -9.81, 0)});
    }
  }

  void frame(double t_s) {
    stabilizer_.push(FrameStamp{next_index_++, time_from_seconds(t_s), std::nullopt});
  }

  void take_cameras() {
    while (const auto camera = stabilizer_.next_camera()) {
      cameras_.push_back(*camera);
      real_.push_back(stabilizer_.real_pose(camera->stamp).q_world_camera);
    }
  }

  /// Both run, as they come live.
  void run(double from_s, double to_s) {
    const int frames = static_cast<int>(std::lround((to_s - from_s) * kFps));
    for (int i = 0; i < frames; ++i) {
      const double t_s = from_s + i / kFps;
      imu_runs(t_s, t_s + 1 / kFps);
      frame(t_s);
      take_cameras();
    }
  }

  void run_without_imu(double from_s, double to_s) {
    const int frames = static_cast<int>(std::lround((to_s - from_s) * kFps));
    for (int i = 0; i < frames; ++i) {
      const double t_s = from_s + i / kFps;
      frame(t_s);
      stabilizer_.coast_to(time_from_seconds(t_s + 0.03));
      take_cameras();
    }
  }

  /// The largest turn of the view from a frame to the next, from the given one on.
  [[nodiscard]] double largest_step_rad(std::size_t from) const {
    double largest = 0;
    for (std::size_t i = from + 1; i < cameras_.size(); ++i) {
      largest = std::max(
          largest, cameras_[i - 1].q_world_camera.angularDistance(cameras_[i].q_world_camera));
    }
    return largest;
  }

  Stabilizer stabilizer_ = make();
  std::int64_t next_index_ = 0;
  std::vector<VirtualCamera> cameras_;
  std::vector<Quaterniond> real_;
};

TEST_F(LiveStabilizer, GlidesToTheRealCameraWhileTheImuIsSilentAndBack) {
  run(0, 2.2);
  const double usual_step_rad = largest_step_rad(kWindow);
  const std::size_t at_loss = cameras_.size();
  run_without_imu(2.2, 4);
  ASSERT_GT(cameras_.size(), at_loss + kWindow);
  EXPECT_LT(cameras_.back().q_world_camera.angularDistance(real_.back()), 1e-6)
      << "still steadied by samples that do not come";
  run(4, 7);
  EXPECT_EQ(cameras_.size(), static_cast<std::size_t>(next_index_) - kLatency) << "frames lost";
  EXPECT_GT(cameras_.back().q_world_camera.angularDistance(real_.back()), 0.1 * kDegree)
      << "not steadied again";
  // The hand turns fastest at whole seconds; a view that jumped would exceed it by degrees.
  EXPECT_LT(largest_step_rad(at_loss), usual_step_rad + 0.3 * kDegree);
}

TEST_F(LiveStabilizer, SaysHowSureItIsOfAFrame) {
  run(0, 3);
  // The filter itself, on the same samples, at the middle line's instant.
  AttitudeEkf ekf;
  const SensorTime middle = time_from_seconds(2 + 0.010);
  Eigen::Matrix3d before = Eigen::Matrix3d::Zero();
  for (int i = 0; time_from_seconds(i / kImuRate) <= middle; ++i) {
    const double t_s = i / kImuRate;
    ekf.update({time_from_seconds(t_s), hand_rate_rad_s(t_s), Vector3d(0, -9.81, 0)});
    before = ekf.predict(time_from_seconds(t_s)).covariance_rad2;
  }
  const FrameStamp stamp{60, time_from_seconds(2), std::nullopt};
  const Eigen::Matrix3d known = stabilizer_.covariance_of(stamp);
  EXPECT_LT((known - before).norm(), 0.1 * before.norm());
  run_without_imu(3, 4);
  const FrameStamp silent{119, time_from_seconds(3.96), std::nullopt};
  EXPECT_GT(stabilizer_.covariance_of(silent).trace(), 1);  // rad²: nobody knows
}

TEST_F(LiveStabilizer, FramesPassWhereTheImuNeverSpeaks) {
  run_without_imu(0, 1);
  EXPECT_EQ(cameras_.size(), static_cast<std::size_t>(next_index_) - kLatency);
}

TEST_F(LiveStabilizer, WhatWaitsComesOutWhenTheCameraIsGone) {
  run(0, 2);
  EXPECT_LT(cameras_.size(), static_cast<std::size_t>(next_index_));
  stabilizer_.begin_path(path());
  take_cameras();
  EXPECT_EQ(cameras_.size(), static_cast<std::size_t>(next_index_));
  imu_runs(2, 5);
  const std::size_t before = cameras_.size();
  run(5, 6);
  EXPECT_EQ(cameras_.size(), static_cast<std::size_t>(next_index_) - kLatency);
  EXPECT_LT(cameras_[before].q_world_camera.angularDistance(real_[before]), 1e-9)
      << "the first frame of a path has no past to be steadied by";
  for (std::size_t i = 1; i < cameras_.size(); ++i) {
    EXPECT_LT(cameras_[i - 1].stamp.time, cameras_[i].stamp.time);
  }
}

TEST_F(LiveStabilizer, AReplacedPathOfTheSameKindChangesNothing) {
  LiveStabilizer::run(0, 2);
  Stabilizer other = make();
  stabilizer_.replace_path(path(), options());
  run(2, 4);
  const std::vector<VirtualCamera> replaced = std::exchange(cameras_, {});

  stabilizer_ = std::move(other);
  next_index_ = 0;
  run(0, 2);
  run(2, 4);
  ASSERT_EQ(replaced.size(), cameras_.size());
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    EXPECT_EQ(replaced[i].stamp.index, cameras_[i].stamp.index);
    EXPECT_LT(replaced[i].q_world_camera.angularDistance(cameras_[i].q_world_camera), 1e-9) << i;
  }
}

TEST_F(LiveStabilizer, ALongerLatencyHoldsTheNextFramesAndRepeatsNone) {
  run(0, 2);
  stabilizer_.replace_path(make_hann_path(kWindow, {}, 2 * kLatency), options());
  run(2, 4);
  EXPECT_EQ(cameras_.size(), static_cast<std::size_t>(next_index_) - 2 * kLatency);
  for (std::size_t i = 0; i < cameras_.size(); ++i) {
    EXPECT_EQ(cameras_[i].stamp.index, static_cast<std::int64_t>(i));
  }
}

/// A choice that is changed on the way.
struct Change {
  std::string name;
  PathLatency latency = kLatency;
  ZoomChoice zoom{1.15, 1.15};
  BoundedPathParameters parameters{};
};

class ChangedOnTheWay : public LiveStabilizer, public ::testing::WithParamInterface<Change> {
 protected:
  void take(const Change& choice) {
    StabilizerOptions crop;
    crop.border = Border::crop;
    stabilizer_.replace_path(make_bounded_path(choice.parameters, choice.zoom, choice.latency),
                             crop);
  }

  [[nodiscard]] double largest_zoom_step(std::size_t from) const {
    double largest = 0;
    for (std::size_t i = from + 1; i < cameras_.size(); ++i) {
      const double ratio = cameras_[i].intrinsics.fx / cameras_[i - 1].intrinsics.fx;
      largest = std::max(largest, std::abs(std::log(ratio)));
    }
    return largest;
  }
};

INSTANTIATE_TEST_SUITE_P(
    Live, ChangedOnTheWay,
    ::testing::Values(Change{"Amount", kLatency, {1.15, 1.15}, {0.2, {}}}, Change{"Nothing"},
                      Change{"MoreZoom", kLatency, {1.4, 1.4}},
                      Change{"LessZoom", kLatency, {1.05, 1.05}},
                      Change{"AutomaticZoom", kLatency, {1, 1.25}}, Change{"MoreLatency", 15},
                      Change{"NoLatency", 0},
                      Change{"Horizon", kLatency, {1.15, 1.15}, {1, {Horizon::hard, 1}}}),
    [](const ::testing::TestParamInfo<Change>& change) { return change.param.name; });

TEST_P(ChangedOnTheWay, ThePictureGlidesThere) {
  take({});
  run(0, 4);
  const double usual_step_rad = largest_step_rad(45);
  const std::size_t at_change = cameras_.size() - 1;
  take(GetParam());
  take_cameras();
  run(4, 8);
  EXPECT_EQ(cameras_.size(), static_cast<std::size_t>(next_index_) - *GetParam().latency);
  // Within a second and a half, and what the other path itself does beside it.
  EXPECT_LT(largest_zoom_step(at_change), 0.012);
  EXPECT_LT(
      cameras_[at_change].q_world_camera.angularDistance(cameras_[at_change + 1].q_world_camera),
      usual_step_rad + 0.1 * kDegree);
  EXPECT_LT(largest_step_rad(at_change), usual_step_rad + 0.5 * kDegree);
}

}  // namespace
}  // namespace gimbal

#include "tests/support/synthetic_tracks.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/random.hpp"
#include "pipeline/lens/lens.hpp"
#include "pipeline/timing/row_timing.hpp"

namespace gimbal::test {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr SensorDuration kLead = std::chrono::milliseconds(200);  // the IMU is on for longer
constexpr double kLossPerFrame = 0.03;
constexpr double kBorder_px = 8;
constexpr double kObjectSpeed_m_s = 1.5;

/// Where the hand holds the camera, world axes.
class Sway {
 public:
  Sway(double rms_m, Random& random) {
    for (Sine& sine : sines_) {
      sine = {rms_m * std::sqrt(2.0 / kSines), random.uniform(0.2, 2.0) * 2 * std::numbers::pi,
              random.uniform(0, 2 * std::numbers::pi)};
    }
  }

  [[nodiscard]] Vector3d at(double time_s) const {
    Vector3d place_m = Vector3d::Zero();
    for (std::size_t i = 0; i < sines_.size(); ++i) {
      const Sine& sine = sines_.at(i);
      place_m[static_cast<Eigen::Index>(i) % 3] +=
          sine.amplitude_m * std::sin(sine.rate_rad_s * time_s + sine.phase_rad);
    }
    return place_m;
  }

 private:
  static constexpr std::size_t kSines = 8;  // an axis
  struct Sine {
    double amplitude_m;
    double rate_rad_s;
    double phase_rad;
  };
  std::array<Sine, 3 * kSines> sines_{};
};

/// Something in the scene, and what is being followed of it.
struct Corner {
  Vector3d place_m;  ///< at time zero, world axes
  Vector3d velocity_m_s;
  FeatureTrack track;
};

class Filming {
 public:
  explicit Filming(const TrackScenario& scenario)
      : scenario_(scenario),
        random_(scenario.seed),
        motion_(make_hand_motion(scenario.hand, scenario.duration, scenario.seed)),
        sway_(scenario.hand_sway_m, random_),
        lens_(*Lens::create(scenario.camera.lens)),
        timing_(scenario.camera) {}

  void film(JointData& data) {
    const auto frames =
        static_cast<std::int64_t>(to_seconds(scenario_.duration) * scenario_.camera.fps);
    for (std::int64_t i = 0; i < frames; ++i) {
      const FrameStamp stamp{i,
                             time_from_seconds(static_cast<double>(i) / scenario_.camera.fps) -
                                 scenario_.camera.time_offset,
                             std::nullopt};
      data.frames.push_back(stamp);
      see(stamp, data);
    }
    for (Corner& corner : followed_) data.tracks.push_back(std::move(corner.track));
  }

  std::vector<GyroSample> feel() {
    std::vector<GyroSample> samples;
    const double noise = scenario_.gyro_noise_rad_s * std::sqrt(scenario_.gyro_rate_hz / 2);
    const SensorTime end = SensorTime(scenario_.duration + kLead);
    for (std::int64_t i = 0;; ++i) {
      const SensorTime time = SensorTime(-kLead) + duration_from_seconds(static_cast<double>(i) /
                                                                         scenario_.gyro_rate_hz);
      if (time > end) return samples;
      const Vector3d deviation(random_.normal(), random_.normal(), random_.normal());
      samples.push_back({time, scenario_.M_camera_imu.transpose() * motion_.at(time).rate_rad_s +
                                   scenario_.gyro_bias_rad_s + noise * deviation});
    }
  }

 private:
  void see(const FrameStamp& stamp, JointData& data) {
    std::vector<Corner> kept;
    for (Corner& corner : followed_) {
      const auto px = seen_at(corner, stamp);
      if (px && is_inside(*px) && random_.uniform() > kLossPerFrame) {
        add_point(corner, stamp, *px);
        kept.push_back(std::move(corner));
      } else {
        data.tracks.push_back(std::move(corner.track));
      }
    }
    followed_ = std::move(kept);
    while (static_cast<int>(followed_.size()) < scenario_.corners) {
      const Vector2d px(random_.uniform(kBorder_px, scenario_.camera.size.width - kBorder_px),
                        random_.uniform(kBorder_px, scenario_.camera.size.height - kBorder_px));
      followed_.push_back(corner_at(px, stamp));
      add_point(followed_.back(), stamp, px);
    }
  }

  Corner corner_at(const Vector2d& px, const FrameStamp& stamp) {
    const SensorTime time = timing_.time_of_line(stamp, px.y());
    const double time_s = seconds_since_epoch(time);
    const double distance_m =
        scenario_.nearest_m *
        std::pow(scenario_.farthest_m / scenario_.nearest_m, random_.uniform());
    Corner corner;
    corner.velocity_m_s.setZero();
    if (random_.uniform() < scenario_.moving_share) {
      const Vector3d direction(random_.normal(), random_.normal(), random_.normal());
      corner.velocity_m_s = kObjectSpeed_m_s * direction;
    }
    corner.place_m = sway_.at(time_s) +
                     distance_m * (motion_.at(time).q_world_camera * *lens_.unproject(px)) -
                     corner.velocity_m_s * time_s;
    return corner;
  }

  /// The row where a corner is seen is the row whose instant decides where it is seen.
  std::optional<Vector2d> seen_at(const Corner& corner, const FrameStamp& stamp) const {
    Vector2d px = corner.track.back().px;
    for (int round = 0; round < 4; ++round) {
      const SensorTime time = timing_.time_of_line(stamp, px.y());
      const double time_s = seconds_since_epoch(time);
      const Vector3d away_m = corner.place_m + corner.velocity_m_s * time_s - sway_.at(time_s);
      const auto next = lens_.project(motion_.at(time).q_world_camera.conjugate() * away_m);
      if (!next) return std::nullopt;
      px = *next;
    }
    return px;
  }

  [[nodiscard]] bool is_inside(const Vector2d& px) const {
    return px.x() > kBorder_px && px.x() < scenario_.camera.size.width - kBorder_px &&
           px.y() > kBorder_px && px.y() < scenario_.camera.size.height - kBorder_px;
  }

  void add_point(Corner& corner, const FrameStamp& stamp, const Vector2d& px) {
    const Vector2d noise(random_.normal(), random_.normal());
    const Vector2d found = px + scenario_.corner_noise_px * noise;
    corner.track.push_back({static_cast<std::size_t>(stamp.index), found});
  }

  const TrackScenario& scenario_;
  Random random_;
  Motion motion_;
  Sway sway_;
  Lens lens_;
  RowTiming timing_;
  std::vector<Corner> followed_;
};

}  // namespace

CameraCalibration camera_720p(SensorDuration readout) {
  CameraCalibration camera;
  camera.size = {1280, 720};
  camera.fps = 30;
  camera.lens.K << 1223.0, 0, 650.4, 0, 1217.5, 345.3, 0, 0, 1;
  camera.readout = readout;
  return camera;
}

JointData make_tracks(const TrackScenario& scenario) {
  JointData data;
  data.camera = scenario.camera;
  Filming filming(scenario);
  filming.film(data);
  data.gyro = filming.feel();
  return data;
}

}  // namespace gimbal::test

#include "drivers/synthetic/hand_motion.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>

#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/world.hpp"

namespace gimbal {
namespace {

constexpr SensorDuration kSpacing = std::chrono::milliseconds(4);  // vibration up to 60 Hz
constexpr std::int64_t kKnotsAround = 75;  // for what sensors see just before and after
constexpr int kSinesInBand = 8;            // their beats make no two steps alike

constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180.0;
}

Eigen::Vector3d radians(double x_deg, double y_deg, double z_deg) {
  return {radians(x_deg), radians(y_deg), radians(z_deg)};
}

/// One sine on one axis; a band of noise is a sum of them.
struct Sine {
  Eigen::Index axis;
  double amplitude;
  double frequency_rad_s;
  double phase_rad;
};

std::vector<Sine> draw_sines(const std::vector<OscillationBand>& bands, Random& random) {
  std::vector<Sine> sines;
  for (const OscillationBand& band : bands) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < kSinesInBand; ++i) {
        const double frequency_hz = random.uniform(band.low_hz, band.high_hz);
        const double phase_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
        sines.push_back({axis, band.rms[axis] * std::sqrt(2.0 / kSinesInBand),
                         2.0 * std::numbers::pi * frequency_hz, phase_rad});
      }
    }
  }
  return sines;
}

Eigen::Vector3d displacement(const std::vector<Sine>& sines, double t_s) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Sine& sine : sines) {
    sum[sine.axis] += sine.amplitude * std::sin(sine.frequency_rad_s * t_s + sine.phase_rad);
  }
  return sum;
}

Eigen::Vector3d acceleration(const std::vector<Sine>& sines, double t_s) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Sine& sine : sines) {
    sum[sine.axis] -= sine.amplitude * sine.frequency_rad_s * sine.frequency_rad_s *
                      std::sin(sine.frequency_rad_s * t_s + sine.phase_rad);
  }
  return sum;
}

/// Angle `t_s` into a turn whose rate is a raised cosine.
double turned(const Pan& pan, double t_s) {
  const double share = t_s / to_seconds(pan.turn);
  const double tau = 2.0 * std::numbers::pi;
  return pan.angle_rad * (share - std::sin(tau * share) / tau);
}

/// Heading to the left at time t, for a pan that begins with a rest in the middle of its swing.
double pan_angle(const Pan& pan, double t_s) {
  if (pan.angle_rad == 0.0 || t_s < 0.0) return -0.5 * pan.angle_rad;
  const double rest_s = to_seconds(pan.rest);
  const double half_period_s = rest_s + to_seconds(pan.turn);
  const double in_half = std::fmod(t_s, half_period_s);
  const bool returning = std::fmod(t_s, 2.0 * half_period_s) >= half_period_s;
  const double angle = in_half < rest_s ? 0.0 : turned(pan, in_half - rest_s);
  return (returning ? pan.angle_rad - angle : angle) - 0.5 * pan.angle_rad;
}

Eigen::Quaterniond orientation(const HandModel& model, const std::vector<Sine>& sines, double t_s) {
  const Eigen::Vector3d shake = displacement(sines, t_s);
  const Eigen::AngleAxisd heading(pan_angle(model.pan, t_s), Eigen::Vector3d::UnitZ());
  const Eigen::AngleAxisd yaw(shake.y(), Eigen::Vector3d::UnitY());
  const Eigen::AngleAxisd pitch(model.pitch_rad + shake.x(), Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd roll(shake.z(), Eigen::Vector3d::UnitZ());
  return heading * Eigen::Quaterniond(level_R_world_camera()) * yaw * pitch * roll;
}

/// Of the camera at the end of its lever: of the pivot, tangential and centripetal.
Eigen::Vector3d lever_acceleration(const MotionState& state, const Eigen::Vector3d& lever_m) {
  const Eigen::Vector3d& rate = state.rate_rad_s;
  return state.q_world_camera *
         (state.rate_derivative_rad_s2.cross(lever_m) + rate.cross(rate.cross(lever_m)));
}

}  // namespace

HandModel walking_hand() {
  HandModel model;
  model.rotation_rad = {{0.1, 0.6, radians(0.8, 1.5, 0.6)},
                        {0.92, 0.98, radians(0.2, 1.1, 0.8)},
                        {1.84, 1.96, radians(0.9, 0.3, 0.2)},
                        {3.6, 4.0, radians(0.2, 0.1, 0.08)},
                        {6.0, 12.0, radians(0.04, 0.04, 0.03)}};
  model.translation_m = {{0.92, 0.98, {0.0, 0.015, 0.0}}, {1.84, 1.96, {0.008, 0.0, 0.015}}};
  model.lever_camera_m = {0.0, -0.1, 0.35};
  return model;
}

HandModel running_hand() {
  HandModel model;
  model.rotation_rad = {{0.1, 0.6, radians(1.5, 3.0, 1.2)},
                        {1.36, 1.44, radians(0.8, 3.0, 2.2)},
                        {2.72, 2.88, radians(2.6, 0.8, 0.7)},
                        {5.4, 5.8, radians(0.5, 0.3, 0.25)},
                        {6.0, 12.0, radians(0.08, 0.08, 0.06)}};
  model.translation_m = {{1.36, 1.44, {0.0, 0.02, 0.0}}, {2.72, 2.88, {0.01, 0.0, 0.03}}};
  model.lever_camera_m = {0.0, -0.1, 0.35};
  return model;
}

HandModel panning_hand() {
  HandModel model;
  model.rotation_rad = {{0.1, 0.8, radians(0.4, 0.3, 0.3)}, {6.0, 12.0, radians(0.05, 0.05, 0.04)}};
  model.pan = {radians(90.0), std::chrono::milliseconds(2500), std::chrono::milliseconds(1500)};
  model.lever_camera_m = {0.0, 0.0, 0.4};
  return model;
}

HandModel vehicle_mount() {
  HandModel model;
  model.rotation_rad = {{0.05, 0.2, radians(0.3, 4.0, 0.8)},
                        {0.8, 2.5, radians(0.5, 0.1, 0.4)},
                        {10.0, 16.0, radians(0.06, 0.02, 0.05)},
                        {26.0, 34.0, radians(0.015, 0.005, 0.01)}};
  model.translation_m = {{0.8, 2.5, {0.004, 0.004, 0.01}}, {26.0, 34.0, {2e-5, 2e-5, 4e-5}}};
  return model;
}

HandModel tripod() {
  return {};
}

Motion make_hand_motion(const HandModel& model, SensorDuration duration, std::uint64_t seed) {
  Random random(seed);
  const std::vector<Sine> rotation = draw_sines(model.rotation_rad, random);
  const std::vector<Sine> translation = draw_sines(model.translation_m, random);
  MotionKnots knots;
  knots.first = SensorTime(-kKnotsAround * kSpacing);
  knots.spacing = kSpacing;
  const std::int64_t count = duration / kSpacing + 2 * kKnotsAround + 1;
  std::vector<double> knot_s;
  for (std::int64_t k = 0; k < count; ++k) {
    knot_s.push_back(seconds_since_epoch(knots.first + k * kSpacing));
    knots.q_world_camera.push_back(orientation(model, rotation, knot_s.back()));
    knots.acceleration_m_s2.push_back(acceleration(translation, knot_s.back()));
  }
  const Motion turning(knots);
  for (std::size_t k = 0; k < knot_s.size(); ++k) {
    knots.acceleration_m_s2[k] +=
        lever_acceleration(turning.at(time_from_seconds(knot_s[k])), model.lever_camera_m);
  }
  return Motion(knots);
}

}  // namespace gimbal

#include "drivers/synthetic/recorded_motion.hpp"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "drivers/synthetic/world.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/rotation.hpp"
#include "pipeline/sample/upright.hpp"

namespace gimbal {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;
using VectorSeries = std::vector<Eigen::Vector3d>;

constexpr SensorDuration kGrid = std::chrono::milliseconds(10);
constexpr int kGravityWindow = 100;    // grid steps over which a hand's acceleration averages out
constexpr double kGravitySigma = 0.3;  // m/s², what is left of it all the same
constexpr double kBiasSigma = 0.05;    // rad/s, a consumer gyro's
constexpr double kTiltSigma = 1.0;     // rad, hardly known beforehand
constexpr std::ptrdiff_t kKnotsAround = 30;  // for what sensors see just before and after

/// A log resampled to an even grid: item k is at the first gyro sample plus k kGrid.
struct GriddedLog {
  VectorSeries rate_rad_s;  ///< in the middle between grid instants k and k + 1
  VectorSeries accel_m_s2;  ///< at the grid instants; empty if there is none
};

template <typename Sample>
VectorSeries resample(const std::vector<Sample>& samples, Eigen::Vector3d Sample::*value,
                      SensorTime first, std::size_t count) {
  VectorSeries series;
  series.reserve(count);
  std::size_t next = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const SensorTime time = first + static_cast<std::int64_t>(k) * kGrid;
    while (next < samples.size() && samples[next].time < time) ++next;
    if (next == 0 || next == samples.size()) {
      series.push_back((next == 0 ? samples.front() : samples.back()).*value);
      continue;
    }
    const Sample& before = samples[next - 1];
    const Sample& after = samples[next];
    const double share = to_seconds(time - before.time) / to_seconds(after.time - before.time);
    series.push_back(before.*value + share * (after.*value - before.*value));
  }
  return series;
}

GriddedLog grid(const MotionLog& log) {
  const SensorTime first = log.gyro.front().time;
  const auto count = static_cast<std::size_t>((log.gyro.back().time - first) / kGrid);
  GriddedLog gridded;
  gridded.rate_rad_s = resample(log.gyro, &GyroSample::gyro_rad_s, first + kGrid / 2, count);
  if (!log.accel.empty()) {
    gridded.accel_m_s2 = resample(log.accel, &AccelSample::accel_m_s2, first, count);
  }
  return gridded;
}

/// What the log does not say of itself.
struct LogFit {
  Eigen::Quaterniond q_world_imu = Eigen::Quaterniond::Identity();  ///< at the first gyro sample
  Eigen::Vector3d bias_rad_s = Eigen::Vector3d::Zero();
};

/// Orientation at each grid instant.
std::vector<Eigen::Quaterniond> integrate(const VectorSeries& rates, const LogFit& fit) {
  std::vector<Eigen::Quaterniond> q;
  q.reserve(rates.size());
  Eigen::Quaterniond q_world_imu = fit.q_world_imu;
  for (const Eigen::Vector3d& rate : rates) {
    q.push_back(q_world_imu);
    q_world_imu =
        (q_world_imu * quaternion_exp(to_seconds(kGrid) * (rate - fit.bias_rad_s))).normalized();
  }
  return q;
}

/// With no accelerometer, the camera is taken to start level.
LogFit level_start(const Eigen::Matrix3d& R_camera_imu) {
  LogFit fit;
  fit.q_world_imu = Eigen::Quaterniond(Eigen::Matrix3d(level_R_world_camera() * R_camera_imu));
  return fit;
}

/// Horizontal specific force in the world, averaged over windows: zero for the right fit.
Eigen::VectorXd mean_horizontal_force(const GriddedLog& log, const LogFit& fit) {
  const std::vector<Eigen::Quaterniond> q = integrate(log.rate_rad_s, fit);
  const auto windows = static_cast<Eigen::Index>(q.size() / kGravityWindow);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(2 * windows);
  for (std::size_t k = 0; k < static_cast<std::size_t>(windows) * kGravityWindow; ++k) {
    const Eigen::Vector3d force = q[k] * log.accel_m_s2[k];
    mean.segment<2>(2 * static_cast<Eigen::Index>(k / kGravityWindow)) += force.head<2>();
  }
  return mean / kGravityWindow;
}

/// `change`: rotation about the world's x and y (rad), bias (rad/s).
LogFit changed(const LogFit& fit, const Vector5d& change) {
  return {(quaternion_exp({change[0], change[1], 0.0}) * fit.q_world_imu).normalized(),
          fit.bias_rad_s + change.tail<3>()};
}

/// Maximum a posteriori by Gauss-Newton, with a Jacobian by differences.
LogFit fit_to_gravity(const GriddedLog& log) {
  constexpr int kIterations = 8;
  constexpr double kDifference = 1e-6;
  LogFit fit;
  fit.q_world_imu = turn_upright(log.accel_m_s2.front());
  Vector5d prior_sigma;
  prior_sigma << kTiltSigma, kTiltSigma, Eigen::Vector3d::Constant(kBiasSigma);
  const Matrix5d prior = prior_sigma.array().square().inverse().matrix().asDiagonal();
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::VectorXd residual = mean_horizontal_force(log, fit) / kGravitySigma;
    Eigen::Matrix<double, Eigen::Dynamic, 5> jacobian(residual.size(), 5);
    for (Eigen::Index column = 0; column < 5; ++column) {
      const LogFit moved = changed(fit, kDifference * Vector5d::Unit(column));
      jacobian.col(column) =
          (mean_horizontal_force(log, moved) / kGravitySigma - residual) / kDifference;
    }
    Vector5d gradient = jacobian.transpose() * residual;
    gradient.tail<3>() += prior.bottomRightCorner<3, 3>() * fit.bias_rad_s;
    const Matrix5d information = jacobian.transpose() * jacobian + prior;
    fit = changed(fit, -information.ldlt().solve(gradient));
  }
  return fit;
}

/// Turns the world about its vertical so that the camera first heads along x.
Eigen::Quaterniond heading_to_x(const Eigen::Quaterniond& q_world_camera) {
  const Eigen::Vector3d forward = q_world_camera * Eigen::Vector3d::UnitZ();
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(-std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()));
}

/// Takes out what is slower than about a second, with a Hann window.
VectorSeries without_slow_part(const VectorSeries& series) {
  const auto count = static_cast<std::ptrdiff_t>(series.size());
  VectorSeries fast;
  fast.reserve(series.size());
  for (std::ptrdiff_t k = 0; k < count; ++k) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double weights = 0;
    for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, k - kGravityWindow + 1);
         i < std::min<std::ptrdiff_t>(count, k + kGravityWindow); ++i) {
      const double weight =
          1.0 + std::cos(std::numbers::pi * static_cast<double>(i - k) / kGravityWindow);
      sum += weight * series[static_cast<std::size_t>(i)];
      weights += weight;
    }
    fast.push_back(series[static_cast<std::size_t>(k)] - sum / weights);
  }
  return fast;
}

VectorSeries hand_acceleration(const GriddedLog& log,
                               const std::vector<Eigen::Quaterniond>& q_world_imu) {
  VectorSeries acceleration(q_world_imu.size(), Eigen::Vector3d::Zero());
  if (log.accel_m_s2.empty()) return acceleration;
  const Eigen::Vector3d gravity_up(0, 0, kStandardGravity_m_s2);
  for (std::size_t k = 0; k < acceleration.size(); ++k) {
    acceleration[k] = q_world_imu[k] * log.accel_m_s2[k] - gravity_up;
  }
  return without_slow_part(acceleration);
}

/// Knots for a stretch of the log; the ends stand still where the log has no more.
MotionKnots cut(const std::vector<Eigen::Quaterniond>& q_world_camera,
                const VectorSeries& acceleration, SensorDuration start, SensorDuration duration) {
  const std::ptrdiff_t from = start / kGrid - kKnotsAround;
  const std::ptrdiff_t to = (start + duration) / kGrid + kKnotsAround;
  const auto count = static_cast<std::ptrdiff_t>(q_world_camera.size());
  MotionKnots knots;
  knots.first = SensorTime(from * kGrid - start);
  knots.spacing = kGrid;
  for (std::ptrdiff_t k = from; k <= to; ++k) {
    const auto inside = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, count - 1));
    knots.q_world_camera.push_back(q_world_camera[inside]);
    knots.acceleration_m_s2.push_back(acceleration[inside]);
  }
  return knots;
}

}  // namespace

Result<Motion> make_recorded_motion(const MotionLog& log, SensorDuration start,
                                    SensorDuration duration) {
  if (log.gyro.size() < 2) return bad_input("motion log: needs at least two gyro samples");
  const SensorDuration length = log.gyro.back().time - log.gyro.front().time;
  if (start < SensorDuration::zero() || duration <= SensorDuration::zero() ||
      start + duration > length) {
    return bad_input(fmt::format(
        "motion log: it is {:.2f} s long and does not hold {:.2f} s from {:.2f} s; choose less",
        to_seconds(length), to_seconds(duration), to_seconds(start)));
  }
  const GriddedLog gridded = grid(log);
  const LogFit fit = gridded.accel_m_s2.size() < std::size_t{2} * kGravityWindow
                         ? level_start(log.R_camera_imu)
                         : fit_to_gravity(gridded);
  const std::vector<Eigen::Quaterniond> q_world_imu = integrate(gridded.rate_rad_s, fit);
  VectorSeries acceleration = hand_acceleration(gridded, q_world_imu);
  const Eigen::Quaterniond q_imu_camera(Eigen::Matrix3d(log.R_camera_imu.transpose()));
  const auto start_index =
      std::min(static_cast<std::size_t>(start / kGrid), q_world_imu.size() - 1);
  const Eigen::Quaterniond q_heading = heading_to_x(q_world_imu[start_index] * q_imu_camera);
  std::vector<Eigen::Quaterniond> q_world_camera;
  for (std::size_t k = 0; k < q_world_imu.size(); ++k) {
    q_world_camera.push_back((q_heading * q_world_imu[k] * q_imu_camera).normalized());
    acceleration[k] = q_heading * acceleration[k];
  }
  return Motion(cut(q_world_camera, acceleration, start, duration));
}

}  // namespace gimbal

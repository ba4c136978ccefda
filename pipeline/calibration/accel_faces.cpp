#include "pipeline/calibration/accel_faces.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <vector>

#include "pipeline/calibration/still_stretches.hpp"

namespace gimbal {
namespace {

using Errors = Eigen::Matrix<double, 6, 1>;  // scale, then bias

constexpr double kMostRate_rad_s = 3 * std::numbers::pi / 180;
constexpr double kFace = 0.8;  // share of gravity along an axis that lies on a face
constexpr int kRounds = 10;
constexpr double kMostResidual_m_s2 = 0.1;

/// Mean specific force of each still stretch, less its ends, where a hand still touches the device.
std::vector<Eigen::Vector3d> pose_means(std::span<const AccelSample> accel,
                                        std::span<const GyroSample> gyro) {
  constexpr SensorDuration kEnds = std::chrono::milliseconds(150);
  std::vector<Eigen::Vector3d> means;
  for (const Stretch& stretch : still_stretches(gyro, kMostRate_rad_s)) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (const AccelSample& sample : accel) {
      const bool is_inside = sample.time > gyro[stretch.begin].time + kEnds &&
                             sample.time < gyro[stretch.end - 1].time - kEnds;
      if (!is_inside) continue;
      sum += sample.accel_m_s2;
      ++count;
    }
    if (count > 0) means.emplace_back(sum / count);
  }
  return means;
}

/// The faces that no pose shows, such as "+x, -z".
std::string missing_faces(const std::vector<Eigen::Vector3d>& means) {
  std::string missing;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (const int sign : {1, -1}) {
      bool is_there = false;
      for (const Eigen::Vector3d& mean : means) {
        is_there = is_there || sign * mean[axis] > kFace * kStandardGravity_m_s2;
      }
      if (is_there) continue;
      missing += fmt::format("{}{}{}", missing.empty() ? "" : ", ", sign > 0 ? '+' : '-',
                             "xyz"[static_cast<std::size_t>(axis)]);
    }
  }
  return missing;
}

/// True specific force by these errors.
Eigen::Vector3d corrected(const Eigen::Vector3d& mean, const Errors& errors) {
  return (mean - errors.tail<3>()).cwiseQuotient(errors.head<3>());
}

/// Gauss and Newton's step towards lengths of gravity.
Errors step(const std::vector<Eigen::Vector3d>& means, const Errors& errors) {
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Errors gradient = Errors::Zero();
  for (const Eigen::Vector3d& mean : means) {
    const Eigen::Vector3d force = corrected(mean, errors);
    const Eigen::Vector3d direction = force.normalized();
    Errors row;
    row.head<3>() = -direction.cwiseProduct(force).cwiseQuotient(errors.head<3>());
    row.tail<3>() = -direction.cwiseQuotient(errors.head<3>());
    normal += row * row.transpose();
    gradient += row * (force.norm() - kStandardGravity_m_s2);
  }
  return -normal.ldlt().solve(gradient);
}

}  // namespace

AccelErrors fit_accel_errors(std::span<const AccelSample> accel, std::span<const GyroSample> gyro) {
  AccelErrors found;
  const auto means = pose_means(accel, gyro);
  found.poses = means.size();
  if (const std::string missing = missing_faces(means); !missing.empty()) {
    found.reason = fmt::format(
        "lay the device on each of its six faces for two seconds; missing "
        "with an axis up: {}",
        missing);
    return found;
  }
  Errors errors;
  errors << 1, 1, 1, 0, 0, 0;
  for (int round = 0; round < kRounds; ++round) errors += step(means, errors);
  found.scale = errors.head<3>();
  found.bias_m_s2 = errors.tail<3>();
  double sum = 0;
  for (const Eigen::Vector3d& mean : means) {
    sum += std::pow(corrected(mean, errors).norm() - kStandardGravity_m_s2, 2);
  }
  found.residual_m_s2 = std::sqrt(sum / static_cast<double>(means.size()));
  if (!(found.residual_m_s2 < kMostResidual_m_s2)) {
    found.reason = fmt::format("the poses disagree by {:.2f} m/s²; let it lie still for longer",
                               found.residual_m_s2);
  }
  return found;
}

}  // namespace gimbal

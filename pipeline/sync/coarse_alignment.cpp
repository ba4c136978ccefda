#include "pipeline/sync/coarse_alignment.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <utility>

#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

/// Mean angular rates of camera and IMU over the same stretch, each in its own axes.
struct RatePair {
  Eigen::Vector3d camera_rad_s;
  Eigen::Vector3d imu_rad_s;
};

std::vector<RatePair> rates_at(const std::vector<VisualTurn>& turns, const GyroIntegral& gyro,
                               double offset_s) {
  std::vector<RatePair> rates;
  rates.reserve(turns.size());
  for (const VisualTurn& turn : turns) {
    const double from_s = turn.from_s + offset_s;
    const double to_s = turn.to_s + offset_s;
    if (!gyro.covers(from_s, to_s)) continue;
    const Eigen::Quaterniond q_from_to =
        gyro.at(from_s)->q_start_imu.conjugate() * gyro.at(to_s)->q_start_imu;
    rates.push_back({turn.rate_rad_s, quaternion_log(q_from_to) / (to_s - from_s)});
  }
  return rates;
}

void remove_means(std::vector<RatePair>& rates) {
  RatePair mean{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  for (const RatePair& rate : rates) {
    mean.camera_rad_s += rate.camera_rad_s / static_cast<double>(rates.size());
    mean.imu_rad_s += rate.imu_rad_s / static_cast<double>(rates.size());
  }
  for (RatePair& rate : rates) {
    rate.camera_rad_s -= mean.camera_rad_s;
    rate.imu_rad_s -= mean.imu_rad_s;
  }
}

AxesFit fit_axes(const std::vector<RatePair>& rates) {
  Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
  double camera = 0;
  double imu = 0;
  for (const RatePair& rate : rates) {
    correlation += rate.camera_rad_s * rate.imu_rad_s.transpose();
    camera += rate.camera_rad_s.squaredNorm();
    imu += rate.imu_rad_s.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(correlation,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d common = svd.singularValues();
  AxesFit fit;
  fit.M_camera_imu = svd.matrixU() * svd.matrixV().transpose();
  const auto explained = [&](double sum) { return (2 * sum - imu) / camera; };
  fit.explained = explained(common.sum());
  fit.explained_other = explained(common[0] + common[1] - common[2]);
  return fit;
}

}  // namespace

std::vector<double> offsets_of(const OffsetSearch& search) {
  const auto steps = static_cast<int>(search.half_width_s / search.step_s);
  std::vector<double> offsets_s;
  for (int step = -steps; step <= steps; ++step) {
    offsets_s.push_back(search.middle_s + step * search.step_s);
  }
  return offsets_s;
}

std::vector<AxesFit> axes_fits(const std::vector<VisualTurn>& turns, const GyroIntegral& gyro,
                               const OffsetSearch& search) {
  std::vector<AxesFit> fits;
  for (const double offset_s : offsets_of(search)) {
    std::vector<RatePair> rates = rates_at(turns, gyro, offset_s);
    if (rates.size() * 2 < turns.size() || rates.size() < 3) continue;
    remove_means(rates);
    AxesFit fit = fit_axes(rates);
    fit.offset_s = offset_s;
    fits.push_back(fit);
  }
  return fits;
}

std::optional<AxesFit> best_fit(const std::vector<AxesFit>& fits) {
  const auto best = std::max_element(
      fits.begin(), fits.end(),
      [](const AxesFit& a, const AxesFit& b) { return a.explained < b.explained; });
  if (best == fits.end()) return std::nullopt;
  return *best;
}

}  // namespace gimbal

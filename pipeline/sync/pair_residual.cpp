#include "pipeline/sync/pair_residual.hpp"

#include <Eigen/Geometry>
#include <optional>

#include "pipeline/sample/rotation.hpp"
#include "pipeline/sync/cross_matrix.hpp"

namespace gimbal {
namespace {

Eigen::Vector3d with_focal(const Sighting& sighting, double log_focal) {
  return sighting.ray + log_focal * sighting.ray_by_log_focal;
}

}  // namespace

/// One corner, taken from where it was seen first to the instant when it was seen last.
struct PairResidual::Turned {
  GyroState from;
  GyroState to;
  Eigen::Matrix3d R_camera_imu;
  Eigen::Matrix3d R_camera_start;  ///< at the last instant
  Eigen::Matrix3d R_to_from;       ///< between camera axes
  Eigen::Vector3d ray_from;
  Eigen::Vector3d ray_to;
  Eigen::Vector3d expected;  ///< ray, camera axes at the last instant
};

std::optional<PairResidual::Turned> PairResidual::turn(const JointStep& step) const {
  const double offset_s = at_.offset_s + step[JointIndex::offset_s];
  const double readout_s = at_.readout_s + step[JointIndex::readout_s];
  const auto from = gyro_.at(pair_.from.stamp_s + offset_s + readout_s * pair_.from.line);
  const auto to = gyro_.at(pair_.to.stamp_s + offset_s + readout_s * pair_.to.line);
  if (!from || !to) return std::nullopt;
  Turned turned{*from, *to, {}, {}, {}, {}, {}, {}};
  turned.R_camera_imu =
      quaternion_exp(step.segment<3>(JointIndex::axes_rad)).toRotationMatrix() * at_.R_camera_imu;
  turned.R_camera_start = turned.R_camera_imu * to->q_start_imu.toRotationMatrix().transpose();
  const Eigen::Quaterniond bias_between = quaternion_exp((to->bias_lever_s - from->bias_lever_s) *
                                                         step.segment<3>(JointIndex::bias_rad_s));
  turned.R_to_from = turned.R_camera_start * (bias_between * from->q_start_imu).toRotationMatrix() *
                     turned.R_camera_imu.transpose();
  turned.ray_from = with_focal(pair_.from, step[JointIndex::log_focal]);
  turned.ray_to = with_focal(pair_.to, step[JointIndex::log_focal]);
  turned.expected = turned.R_to_from * turned.ray_from;
  return turned;
}

PairResidual::RayRows PairResidual::derivative(const Turned& turned) const {
  const Eigen::Matrix3d& R_to_from = turned.R_to_from;
  const Eigen::Vector3d by_from_time =
      R_to_from * (turned.R_camera_imu * turned.from.rate_rad_s).cross(turned.ray_from);
  const Eigen::Vector3d by_to_time =
      -(turned.R_camera_imu * turned.to.rate_rad_s).cross(turned.expected);
  const Eigen::Vector3d seen_from_start = turned.R_camera_start.transpose() * turned.expected;
  RayRows by_step;
  by_step.col(JointIndex::offset_s) = by_from_time + by_to_time;
  by_step.col(JointIndex::readout_s) = by_from_time * pair_.from.line + by_to_time * pair_.to.line;
  by_step.middleCols<3>(JointIndex::axes_rad) =
      R_to_from * cross_matrix(turned.ray_from) - cross_matrix(turned.expected);
  by_step.middleCols<3>(JointIndex::bias_rad_s) =
      turned.R_camera_start * cross_matrix(seen_from_start) *
      (turned.from.bias_lever_s - turned.to.bias_lever_s);
  by_step.col(JointIndex::log_focal) =
      R_to_from * pair_.from.ray_by_log_focal - pair_.to.ray_by_log_focal;
  return by_step;
}

bool PairResidual::Evaluate(const double* const* parameters, double* residuals,
                            double** jacobians) const {
  const Eigen::Map<const JointStep> step(parameters[0]);
  const auto turned = turn(step);
  if (!turned) return false;
  const PixelByRay px_by_ray =
      pair_.to.px_by_ray + step[JointIndex::log_focal] * pair_.to.px_by_ray_by_log_focal;
  const double depth = turned->expected.dot(turned->ray_to);
  const Eigen::Vector3d miss = turned->expected / depth - turned->ray_to;
  Eigen::Map<Eigen::Vector2d>{residuals} = px_by_ray * miss;
  if (jacobians == nullptr || jacobians[0] == nullptr) return true;
  Eigen::Map<Eigen::Matrix<double, 2, JointIndex::size, Eigen::RowMajor>> rows(jacobians[0]);
  rows = px_by_ray * derivative(*turned);
  rows.col(JointIndex::log_focal) += pair_.to.px_by_ray_by_log_focal * miss;
  return true;
}

}  // namespace gimbal

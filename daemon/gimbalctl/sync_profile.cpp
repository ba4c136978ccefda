#include "daemon/gimbalctl/sync_profile.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace gimbal {
namespace {

FittedCalibration fitted_calibration(const Session& session, const JointParameters& found) {
  Eigen::Matrix3d K = session.camera->lens.K;
  K(0, 0) *= found.focal_scale;
  K(1, 1) *= found.focal_scale;
  FittedCalibration fitted;
  fitted.K = K;
  fitted.readout = duration_from_seconds(std::max(0.0, found.readout_s));
  fitted.time_offset = duration_from_seconds(found.offset_s);
  // Written with all its digits, it is a rotation to all its digits.
  fitted.R_camera_imu = Eigen::Quaterniond(found.R_camera_imu).normalized().toRotationMatrix();
  return fitted;
}

std::string comments(const Session& session, const JointFit& fit) {
  const auto twice_sigma = [&](int index) { return 2 * std::sqrt(fit.covariance(index, index)); };
  return fmt::format("# Fitted {}.\n", by_whom("sync", session)) +
         fmt::format(
             "# 95 % lie within: time_offset_s {:.6f}, readout_s {:.6f}, K {:.3f} %, "
             "R_camera_imu {:.3f} degrees.\n",
             twice_sigma(JointIndex::offset_s), twice_sigma(JointIndex::readout_s),
             100 * twice_sigma(JointIndex::log_focal),
             twice_sigma(JointIndex::axes_rad) * 180 / std::numbers::pi) +
         fmt::format("# {} pairs of corners, {:.0f} % of them agree, {:.2f} px apart.\n", fit.pairs,
                     100 * fit.agreeing, fit.noise_px);
}

}  // namespace

Result<void> write_sync_profile(const Session& session, const JointFit& fit,
                                const ResultFiles& files) {
  return write_calibration_profile(own_toml(session), fitted_calibration(session, fit.parameters),
                                   comments(session, fit), files);
}

}  // namespace gimbal

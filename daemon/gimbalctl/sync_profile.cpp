#include "daemon/gimbalctl/sync_profile.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <system_error>

#include "daemon/durable_file.hpp"
#include "drivers/replay/recalibrated_toml.hpp"
#include "drivers/replay/session_toml.hpp"

namespace gimbal {
namespace {

std::string own_toml(const Session& session) {
  std::ifstream file(session.folder / "session.toml");
  if (!file) return format_session_toml(session);
  return {std::istreambuf_iterator<char>(file), {}};
}

FittedCalibration fitted_calibration(const Session& session, const JointParameters& found) {
  FittedCalibration fitted;
  fitted.K = session.camera->lens.K;
  fitted.K(0, 0) *= found.focal_scale;
  fitted.K(1, 1) *= found.focal_scale;
  fitted.readout = duration_from_seconds(std::max(0.0, found.readout_s));
  fitted.time_offset = duration_from_seconds(found.offset_s);
  // Written with all its digits, it is a rotation to all its digits.
  fitted.R_camera_imu = Eigen::Quaterniond(found.R_camera_imu).normalized().toRotationMatrix();
  return fitted;
}

/// Who reads the file should know how old it is and what it stands on.
std::string heading(const Session& session, const JointFit& fit) {
  const auto twice_sigma = [&](int index) { return 2 * std::sqrt(fit.covariance(index, index)); };
  const std::time_t now = std::time(nullptr);
  return fmt::format("# Fitted by gimbalctl sync on {:%Y-%m-%d} to {}.\n", fmt::gmtime(now),
                     session.folder.filename().string()) +
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

Result<void> write_sync_profile(const Session& session, const Synchronization& found,
                                const std::filesystem::path& path, ExistingFile existing) {
  if (!found.fit || !found.reason.empty()) {
    return bad_input(path.string() + ": not written, since the result cannot be trusted");
  }
  std::error_code ignored;
  if (existing == ExistingFile::kept && std::filesystem::exists(path, ignored)) {
    return bad_input(path.string() + ": is there already; give another name, or --overwrite");
  }
  const auto text =
      recalibrated_toml(own_toml(session), fitted_calibration(session, found.fit->parameters));
  if (!text) return tl::unexpected(text.error());
  return replace_file(path, heading(session, *found.fit) + *text);
}

}  // namespace gimbal

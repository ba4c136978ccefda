#include "pipeline/sync/synchronization.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pipeline/sync/axes.hpp"
#include "pipeline/sync/coarse_alignment.hpp"
#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/sighting.hpp"
#include "pipeline/sync/visual_turn.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kFewestFrames = 30;
constexpr double kFewestCorners = 15;         // followed from one frame to the next
constexpr std::size_t kCornersForTurns = 40;  // a frame, if there are so many
constexpr double kLeastTurning_rad_s = 0.01;  // rms
constexpr double kLeastExplained = 0.5;
constexpr double kRivalAway_s = 0.1;
constexpr double kRivalMisfit = 1.3;  // so much worse than the best is still a rival
constexpr double kMostOffsetSigma_s = 1e-3;
constexpr double kMostReadoutSigma_s = 1e-3;
constexpr double kMostAxesSigma_rad = 0.5 * std::numbers::pi / 180;

/// What is known before the fit, or why there is none.
struct Coarse {
  AxesFit fit;
  bool is_mirrored = false;
};

using Reason = tl::unexpected<std::string>;

tl::expected<void, std::string> check_amount(const JointData& data) {
  if (data.frames.size() < kFewestFrames) {
    return Reason(
        fmt::format("there are only {} frames; {} at least are needed, and a minute is "
                    "better",
                    data.frames.size(), kFewestFrames));
  }
  if (data.gyro.size() < 4) return Reason("there are no gyroscope samples");
  std::size_t followed = 0;
  for (const FeatureTrack& track : data.tracks) followed += track.size() - 1;
  const double per_frame = static_cast<double>(followed) / static_cast<double>(data.frames.size());
  if (per_frame < kFewestCorners) {
    return Reason(
        fmt::format("only {:.0f} corners could be followed from frame to frame; film "
                    "something with more detail and light",
                    per_frame));
  }
  return {};
}

double rms_rate_rad_s(const std::vector<VisualTurn>& turns, const GyroIntegral& gyro,
                      double offset_s) {
  double sum = 0;
  std::size_t count = 0;
  for (const VisualTurn& turn : turns) {
    const auto state = gyro.at((turn.from_s + turn.to_s) / 2 + offset_s);
    if (!state) continue;
    sum += state->rate_rad_s.squaredNorm();
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
}

Eigen::Vector3d mean_rate(const std::vector<GyroSample>& samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const GyroSample& sample : samples) sum += sample.gyro_rad_s;
  return sum / static_cast<double>(samples.size());
}

/// Another offset that would do nearly as well.
std::optional<AxesFit> rival_of(const AxesFit& best, const std::vector<AxesFit>& fits) {
  std::vector<AxesFit> away;
  std::copy_if(fits.begin(), fits.end(), std::back_inserter(away), [&](const AxesFit& fit) {
    return std::abs(fit.offset_s - best.offset_s) > kRivalAway_s;
  });
  auto rival = best_fit(away);
  if (!rival || 1 - rival->explained > kRivalMisfit * (1 - best.explained)) return std::nullopt;
  return rival;
}

tl::expected<Coarse, std::string> align(const JointData& data, const OffsetSearch& search) {
  const SensorTime zero = data.gyro.front().time;
  const auto maker = SightingMaker::create(data.camera, 1, zero);
  if (!maker) return Reason(maker.error().message);
  const auto pairs =
      make_pairs(*maker, data.frames, data.tracks, {.most = kCornersForTurns * data.frames.size()});
  const auto turns = visual_turns(pairs, 1 / data.camera.fps);
  if (turns.size() * 2 < data.frames.size()) {
    return Reason("the picture does not move as one; what moves on its own must not fill it");
  }
  const GyroIntegral gyro(data.gyro, zero, mean_rate(data.gyro));
  const auto fits = axes_fits(turns, gyro, search);
  const auto best = best_fit(fits);
  if (!best) return Reason("the gyroscope's log and the frames have too little time in common");
  if (rms_rate_rad_s(turns, gyro, best->offset_s) < kLeastTurning_rad_s) {
    return Reason("the camera hardly turns; hold it in the hand and shake it a little");
  }
  if (best->explained < kLeastExplained) {
    return Reason(
        fmt::format("the picture does not turn as the gyroscope does ({:.0f} % at best); "
                    "is the offset within {:.1f} s, and does the camera turn?",
                    100 * std::max(0.0, best->explained), search.half_width_s));
  }
  if (const auto rival = rival_of(*best, fits)) {
    return Reason(
        fmt::format("more than one time offset fits: {:.0f} and {:.0f} ms; shake less "
                    "regularly",
                    1e3 * best->offset_s, 1e3 * rival->offset_s));
  }
  return Coarse{*best, best->M_camera_imu.determinant() < 0};
}

/// Axes of a left hand, all three reversed, are those of a right hand.
JointData with_gyro_reversed(JointData data) {
  for (GyroSample& sample : data.gyro) sample.gyro_rad_s = -sample.gyro_rad_s;
  return data;
}

JointParameters reversed(JointParameters parameters) {
  parameters.R_camera_imu = -parameters.R_camera_imu;
  return parameters;
}

/// In words, which of the parameters is not known well enough.
std::string doubt(const JointFit& fit) {
  const auto sigma = [&](int index) { return std::sqrt(fit.covariance(index, index)); };
  const double offset_sigma_s = sigma(JointIndex::offset_s);
  const double readout_sigma_s = sigma(JointIndex::readout_s);
  double axes_sigma_rad = 0;
  for (int axis = 0; axis < 3; ++axis) {
    axes_sigma_rad = std::max(axes_sigma_rad, sigma(JointIndex::axes_rad + axis));
  }
  // Written so that what is not a number is a doubt.
  if (!(offset_sigma_s < kMostOffsetSigma_s)) {
    return fmt::format("the time offset is only known to {:.1f} ms", 2e3 * offset_sigma_s);
  }
  if (!(axes_sigma_rad < kMostAxesSigma_rad)) {
    return fmt::format("the axes are only known to {:.1f} degrees; turn about all three",
                       2 * axes_sigma_rad * 180 / std::numbers::pi);
  }
  if (!(readout_sigma_s < kMostReadoutSigma_s)) {
    return fmt::format("the readout time is only known to {:.1f} ms", 2e3 * readout_sigma_s);
  }
  if (fit.parameters.readout_s < -3 * readout_sigma_s && fit.parameters.readout_s < -1e-3) {
    return "lines are read the other way: turn readout_direction round";
  }
  return "";
}

}  // namespace

Synchronization synchronize(const JointData& data, const Eigen::Matrix3d& R_camera_imu_said) {
  Synchronization result;
  const auto fail = [&](std::string reason) {
    result.reason = std::move(reason);
    return result;
  };
  const OffsetSearch search{.middle_s = to_seconds(data.camera.time_offset)};
  if (const auto enough = check_amount(data); !enough) return fail(enough.error());
  const auto coarse = align(data, search);
  if (!coarse) return fail(coarse.error());

  const Eigen::Matrix3d fault =
      nearest_axes(R_camera_imu_said.transpose() * coarse->fit.M_camera_imu);
  result.axes_fault = axes_fault(fault);
  JointParameters start;
  start.offset_s = coarse->fit.offset_s;
  start.readout_s = 1 / data.camera.fps;
  start.R_camera_imu = coarse->fit.M_camera_imu;
  if (coarse->is_mirrored) start = reversed(start);
  const JointData right_handed = coarse->is_mirrored ? with_gyro_reversed(data) : data;
  const auto fit = fit_jointly(right_handed, start);
  if (!fit) return fail(fit.error().message);
  result.fit = *fit;
  auto curve = offset_curve(right_handed, fit->parameters, search);
  if (curve) result.curve = *std::move(curve);
  result.is_left_handed = coarse->is_mirrored;
  if (result.is_left_handed) {
    return fail(fmt::format("the gyroscope's axes are left-handed: {}", result.axes_fault));
  }
  result.reason = doubt(*fit);
  return result;
}

}  // namespace gimbal

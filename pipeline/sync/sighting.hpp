#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sync/feature_track.hpp"
#include "pipeline/timing/row_timing.hpp"

namespace gimbal {

/// How a pixel moves with the ray that leads to it.
using PixelByRay = Eigen::Matrix<double, 2, 3>;

/// A corner in one picture: when its row was exposed, and which ray it is. The instant is
/// stamp_s + time offset + readout · line.
struct Sighting {
  std::size_t frame = 0;
  double stamp_s = 0;   ///< less half the exposure where that is known
  double line = 0;      ///< along the readout, as a share of it
  Eigen::Vector3d ray;  ///< unit, camera axes
  PixelByRay px_by_ray;
  /// How both change with the logarithm of the focal length while the pixel stays.
  Eigen::Vector3d ray_by_log_focal;
  PixelByRay px_by_ray_by_log_focal;
};

/// The same corner in two pictures.
struct SightingPair {
  Sighting from;
  Sighting to;
};

/// What turns the pixels of tracks into sightings.
class SightingMaker {
 public:
  /// `focal_scale`: what both focal lengths of the calibration are multiplied by. Times count from
  /// `zero`.
  [[nodiscard]] static Result<SightingMaker> create(const CameraCalibration& camera,
                                                    double focal_scale, SensorTime zero);

  /// Nothing where no ray leads to the pixel.
  [[nodiscard]] std::optional<Sighting> make(const FrameStamp& stamp,
                                             const TrackPoint& point) const;

 private:
  SightingMaker(Lens lens, Lens longer, Lens shorter, const CameraCalibration& camera,
                SensorTime zero);

  Lens lens_;
  Lens longer_;  ///< of a slightly longer and a slightly shorter focal length, for derivatives
  Lens shorter_;
  RowTiming at_once_;     ///< as if all lines were read at once
  RowTiming one_second_;  ///< as if reading took a second
  ReadoutDirection direction_;
  SensorTime zero_;
};

/// Which points of a track are compared: those `stride` pictures apart.
struct PairChoice {
  std::size_t stride = 1;
  std::size_t most = 20000;  ///< if there are more, evenly spread ones are taken
};

/// Pairs of all tracks, in the order of their first pictures.
[[nodiscard]] std::vector<SightingPair> make_pairs(const SightingMaker& maker,
                                                   const std::vector<FrameStamp>& frames,
                                                   const std::vector<FeatureTrack>& tracks,
                                                   const PairChoice& choice);

}  // namespace gimbal

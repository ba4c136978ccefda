#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gimbal {

/// How bright each line of a picture is, in the order in which they are read.
struct LineProfile {
  double time_s = 0;          ///< the frame's stamp
  std::vector<double> light;  ///< linear, any unit
};

/// What the bands tell that a flashing light draws over the pictures of a rolling shutter.
struct FlashingLight {
  /// Why it is not to be trusted, in one line; empty if it is.
  std::string reason;
  double readout_s = 0;        ///< from the first line to one past the last
  double readout_sigma_s = 0;  ///< from how parts of the recording differ
  /// Taken for shorter than half of the light's period, since as much less than a whole looks the
  /// same. Nothing where the bands are no square wave's.
  std::optional<double> exposure_s;
  double bands = 0;      ///< in a picture
  double coherence = 0;  ///< 1 if bands move on from frame to frame as the stated frequency has it
  /// Share of the changing brightness that bands of a number explain: number, share.
  std::vector<std::pair<double, double>> spectrum;
};

/// The readout time from a light that flashes `light_hz` times a second, on for half of the time,
/// and shines on all of the picture (thesis 2.4). A light of another frequency, such as the mains'
/// 100 or 120 Hz, is told apart by how its bands move on from frame to frame. Preconditions: all
/// profiles are of the same length; times rise.
[[nodiscard]] FlashingLight measure_flashing_light(std::span<const LineProfile> profiles,
                                                   double light_hz);

}  // namespace gimbal

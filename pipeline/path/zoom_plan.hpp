#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pipeline/path/camera_path.hpp"

namespace gimbal {

/// The zoom that a frame's view needs.
struct ZoomNeed {
  double time_s = 0;
  double zoom = 1;
};

/// Breathes: zooms in before it is needed as far as the future is known, and out again, both so
/// slowly that the eye does not follow.
class ZoomPlan {
 public:
  explicit ZoomPlan(ZoomChoice choice) : choice_(choice) {}

  [[nodiscard]] bool is_fixed() const { return choice_.least >= choice_.most; }

  /// The zooms of the next frames; the first of them is what the next plan starts from. Times rise.
  [[nodiscard]] std::vector<double> plan(std::span<const ZoomNeed> needs);

 private:
  ZoomChoice choice_;
  std::optional<ZoomNeed> last_;
};

}  // namespace gimbal

#include "pipeline/path/zoom_plan.hpp"

#include <algorithm>

namespace gimbal {
namespace {

/// There is no haste to zoom out.
constexpr double kFallPerRise = 0.25;

}  // namespace

std::vector<double> ZoomPlan::plan(std::span<const ZoomNeed> needs) {
  std::vector<double> zooms(needs.size(), choice_.least);
  if (is_fixed() || needs.empty()) return zooms;
  const double rise_per_s = choice_.speed_per_s;
  const double fall_per_s = kFallPerRise * rise_per_s;
  // What has to be begun now to be there in time.
  double wanted = choice_.least;
  for (std::size_t i = needs.size(); i-- > 0;) {
    if (i + 1 < needs.size()) wanted -= rise_per_s * (needs[i + 1].time_s - needs[i].time_s);
    wanted = std::max(wanted, std::clamp(needs[i].zoom, choice_.least, choice_.most));
    zooms[i] = wanted;
  }
  std::optional<ZoomNeed> before = last_;
  for (std::size_t i = 0; i < needs.size(); ++i) {
    if (before) {
      const double passed_s = needs[i].time_s - before->time_s;
      zooms[i] = std::clamp(zooms[i], before->zoom - fall_per_s * passed_s,
                            before->zoom + rise_per_s * passed_s);
    }
    before = ZoomNeed{needs[i].time_s, zooms[i]};
  }
  last_ = ZoomNeed{needs[0].time_s, zooms[0]};
  return zooms;
}

}  // namespace gimbal

#pragma once

#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/sync/coarse_alignment.hpp"
#include "pipeline/sync/joint_fit.hpp"

namespace gimbal {

/// How badly the gyroscope explains the picture at one time offset.
struct OffsetCost {
  double offset_s = 0;
  double cost_px2 = 0;  ///< mean square distance; a corner counts for 20 px at most
};

/// J(t_d) as figure 2.4 of the thesis has it, everything but the offset as fitted. From some of the
/// corners; offsets at which the gyroscope's log covers less than half of them are left out.
[[nodiscard]] Result<std::vector<OffsetCost>> offset_curve(const JointData& data,
                                                           const JointParameters& fitted,
                                                           const OffsetSearch& search);

}  // namespace gimbal

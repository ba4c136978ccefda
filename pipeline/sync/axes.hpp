#pragma once

#include <Eigen/Core>
#include <string>

namespace gimbal {

/// The permutation of axes with signs that is closest to an orthogonal matrix.
[[nodiscard]] Eigen::Matrix3d nearest_axes(const Eigen::Matrix3d& orthogonal);

/// In words, what is wrong with axes if `found` has to be applied to them first: "y and z are
/// swapped", "x has the wrong sign". Empty for the identity. Precondition: a permutation with
/// signs.
[[nodiscard]] std::string axes_fault(const Eigen::Matrix3d& found);

}  // namespace gimbal

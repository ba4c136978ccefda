#pragma once

#include <Eigen/Core>
#include <string_view>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Turns the raw numbers of a three-axis sensor into SI units: `mount (raw + offset) scale`
/// (kernel: Documentation/ABI/testing/sysfs-bus-iio, `scale`, `offset`, `mount_matrix`).
struct AxesScaling {
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Matrix3d R_board_chip = Eigen::Matrix3d::Identity();

  [[nodiscard]] Eigen::Vector3d apply(const Eigen::Vector3d& raw) const {
    return R_board_chip * (raw + offset).cwiseProduct(scale);
  }
};

/// Reads "xx, xy, xz; yx, yy, yz; zx, zy, zz", as IIO prints a mount matrix. It must be orthonormal
/// to the digits that device trees give; one of determinant -1 is refused, too.
[[nodiscard]] Result<Eigen::Matrix3d> parse_mount_matrix(std::string_view text);

}  // namespace gimbal

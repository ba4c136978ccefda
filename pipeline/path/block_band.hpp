#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace gimbal {

/// A symmetric positive definite matrix of 3x3 blocks that reaches three blocks to either side of
/// its diagonal, as a third difference makes it.
class BlockBand {
 public:
  static constexpr std::size_t kReach = 3;

  /// Zero, of `size` block rows.
  void reset(std::size_t size);

  /// Block in row `row` and column `row - back`; `back` up to kReach and `row`.
  [[nodiscard]] Eigen::Matrix3d& block(std::size_t row, std::size_t back) {
    return rows_[row][back];
  }

  /// Becomes its Cholesky factor.
  void factorize();

  /// After `factorize`: x becomes the solution of A y = x.
  void solve_in_place(std::vector<Eigen::Vector3d>& x) const;

 private:
  std::vector<std::array<Eigen::Matrix3d, kReach + 1>> rows_;  ///< lower half
};

}  // namespace gimbal

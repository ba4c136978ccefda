#include "pipeline/path/block_band.hpp"

#include <algorithm>

namespace gimbal {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void BlockBand::reset(std::size_t size) {
  std::array<Matrix3d, kReach + 1> zero;
  zero.fill(Matrix3d::Zero());
  rows_.assign(size, zero);
}

void BlockBand::factorize() {
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    auto& here = rows_[row];
    const std::size_t reach = std::min(kReach, row);
    for (std::size_t back = reach + 1; back-- > 0;) {
      const auto& there = rows_[row - back];  // of the block's column
      Matrix3d& block = here[back];
      for (std::size_t k = back + 1; k <= reach; ++k) {
        block.noalias() -= here[k].lazyProduct(there[k - back].transpose());
      }
      if (back > 0) {
        there[0].triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(block);
      } else {
        block = Matrix3d(block.llt().matrixL());
      }
    }
  }
}

void BlockBand::solve_in_place(std::vector<Vector3d>& x) const {
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (std::size_t back = 1; back <= std::min(kReach, row); ++back) {
      x[row].noalias() -= rows_[row][back] * x[row - back];
    }
    rows_[row][0].triangularView<Eigen::Lower>().solveInPlace(x[row]);
  }
  for (std::size_t row = rows_.size(); row-- > 0;) {
    rows_[row][0].triangularView<Eigen::Lower>().transpose().solveInPlace(x[row]);
    for (std::size_t back = 1; back <= std::min(kReach, row); ++back) {
      x[row - back].noalias() -= rows_[row][back].transpose() * x[row];
    }
  }
}

}  // namespace gimbal

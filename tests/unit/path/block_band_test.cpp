#include "pipeline/path/block_band.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <random>
#include <vector>

namespace gimbal {
namespace {

class BlockBandOfSize : public ::testing::TestWithParam<std::size_t> {};

TEST_P(BlockBandOfSize, SolvesLikeADenseMatrix) {
  const std::size_t size = GetParam();
  const auto rows = static_cast<Eigen::Index>(3 * size);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BlockBand band;
  band.reset(size);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows, rows);
  for (std::size_t row = 0; row < size; ++row) {
    for (std::size_t back = 0; back <= std::min(row, BlockBand::kReach); ++back) {
      Eigen::Matrix3d block = Eigen::Matrix3d::NullaryExpr([&] { return uniform(random); });
      // Heavy on the diagonal, so that it is positive definite.
      if (back == 0) {
        block = (block + block.transpose()).eval() + 20 * Eigen::Matrix3d::Identity();
      }
      band.block(row, back) = block;
      const auto at = static_cast<Eigen::Index>(3 * row);
      const auto before = static_cast<Eigen::Index>(3 * (row - back));
      dense.block<3, 3>(at, before) = block;
      dense.block<3, 3>(before, at) = block.transpose();
    }
  }
  std::vector<Eigen::Vector3d> x(size);
  Eigen::VectorXd right(rows);
  for (std::size_t i = 0; i < size; ++i) {
    x[i] = Eigen::Vector3d::NullaryExpr([&] { return uniform(random); });
    right.segment<3>(static_cast<Eigen::Index>(3 * i)) = x[i];
  }
  const Eigen::VectorXd expected = dense.ldlt().solve(right);
  band.factorize();
  band.solve_in_place(x);
  for (std::size_t i = 0; i < size; ++i) {
    EXPECT_LT((x[i] - expected.segment<3>(static_cast<Eigen::Index>(3 * i))).norm(), 1e-12) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(BlockBand, BlockBandOfSize, ::testing::Values(1, 2, 3, 4, 5, 40));

}  // namespace
}  // namespace gimbal

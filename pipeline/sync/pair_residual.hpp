#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <optional>

#include "pipeline/sync/gyro_integral.hpp"
#include "pipeline/sync/joint_fit.hpp"
#include "pipeline/sync/sighting.hpp"

namespace gimbal {

/// Small corrections to JointParameters, in the order of JointIndex.
using JointStep = Eigen::Matrix<double, JointIndex::size, 1>;

/// How far a corner was seen from where the gyroscope takes it, in pixels, as a function of a
/// JointStep from `at`.
class PairResidual : public ceres::SizedCostFunction<2, JointIndex::size> {
 public:
  /// `gyro` has the bias of `at` taken off; `pair` was made with its focal length. All outlive
  /// this.
  PairResidual(const SightingPair& pair, const GyroIntegral& gyro, const JointParameters& at)
      : pair_(pair), gyro_(gyro), at_(at) {}

  /// False where the gyroscope's log does not reach.
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  struct Turned;
  using RayRows = Eigen::Matrix<double, 3, JointIndex::size>;

  [[nodiscard]] std::optional<Turned> turn(const JointStep& step) const;
  [[nodiscard]] RayRows derivative(const Turned& turned) const;

  const SightingPair& pair_;
  const GyroIntegral& gyro_;
  const JointParameters& at_;
};

}  // namespace gimbal

#include "pipeline/fill/seam_shift.hpp"

#include <Eigen/Dense>

namespace gimbal {
namespace {

/// A cell that differs by more is likely to show something else.
constexpr float kUsualDifference = 12;

/// Cells with an edge of 8 levels a pixel that it takes along either axis.
constexpr float kLeastInformation = 4 * 64;

/// What was learned counts for so much of itself with each that is new.
constexpr double kMemory = 0.97;

/// As if it had been seen once over so long that nothing drifts.
constexpr double kPrior_s = 0.05;

}  // namespace

Eigen::Vector2f seam_shift_px(const std::vector<CellPair>& pairs, const Tone& tone) {
  Eigen::Matrix2f information = Eigen::Matrix2f::Zero();
  Eigen::Vector2f product = Eigen::Vector2f::Zero();
  for (const CellPair& pair : pairs) {
    const Eigen::Vector2f gradient =
        (pair.wanted.luma_gradient() + tone.gain * pair.given.luma_gradient()) / 2;
    const float off = tone.luma(pair.given.mean_luma()) - pair.wanted.mean_luma();
    const float weight = 1 / (1 + (off / kUsualDifference) * (off / kUsualDifference));
    information += weight * gradient * gradient.transpose();
    product += weight * off * gradient;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2f> axes(information);
  Eigen::Vector2f shift = Eigen::Vector2f::Zero();
  for (int i = 0; i < 2; ++i) {
    if (axes.eigenvalues()[i] < kLeastInformation) continue;
    const Eigen::Vector2f axis = axes.eigenvectors().col(i);
    shift += axis * (axis.dot(product) / axes.eigenvalues()[i]);
  }
  return shift;
}

Eigen::Vector2f SeamDrift::expected_px(double later_s) const {
  return (product_px_s_ / (square_s2_ + kPrior_s * kPrior_s) * later_s).cast<float>();
}

void SeamDrift::learn(double later_s, const Eigen::Vector2f& moved_px) {
  square_s2_ = kMemory * square_s2_ + later_s * later_s;
  product_px_s_ = kMemory * product_px_s_ + later_s * moved_px.cast<double>();
}

}  // namespace gimbal

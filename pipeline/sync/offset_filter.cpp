#include "pipeline/sync/offset_filter.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

// What clocks do: a phone's part by 30 ms a minute.
constexpr double kDriftSigma = 0.5e-3;
constexpr double kDriftMemory_s = 300;
constexpr double kOffsetWalk_s2_s = 5e-5 * 5e-5;
// What gyroscopes do.
constexpr double kBiasSigma_rad_s = 0.02;
constexpr double kBiasWalk_rad2_s3 = 1e-4 * 1e-4;
// What pictures do.
constexpr double kTurnShare = 0.005;       // of a turn: a lens, or axes, not quite known
constexpr double kLeastMiss_rad = 5e-5;    // a twentieth of a pixel
constexpr double kNeighboursAlike = 2;     // misses of a burst share their corners' errors
constexpr double kSwaySigma_rad_s = 2e-3;  // what a hand that moves aside seems to turn by
constexpr double kSwayMemory_s = 0.2;      // ... and for how long
constexpr double kLeastScatter = 1;        // of that, in its variance
constexpr double kMostScatter = 400;
constexpr double kScatterStep = 0.05;    // of its logarithm, a miss
constexpr double kMedianOfChi2 = 2.366;  // three degrees of freedom
// Squared distances, in standard deviations.
constexpr double kDoubted = 9;
constexpr double kRefused = 30;
constexpr double kJump = 25;
constexpr double kJumpMemory = 0.85;  // from a miss to the next

}  // namespace

OffsetFilter::OffsetFilter(double offset_s, double sigma_s) {
  covariance_(kDrift, kDrift) = kDriftSigma * kDriftSigma;
  covariance_.diagonal().segment<3>(kBias).setConstant(kBiasSigma_rad_s * kBiasSigma_rad_s);
  restart(offset_s, sigma_s);
}

double OffsetFilter::sigma_s() const {
  return std::sqrt(covariance_(kOffset, kOffset));
}

void OffsetFilter::restart(double offset_s, double sigma_s) {
  state_[kOffset] = offset_s;
  covariance_.row(kOffset).setZero();
  covariance_.col(kOffset).setZero();
  covariance_(kOffset, kOffset) = sigma_s * sigma_s;
  jump_gradient_ = 0;
  jump_normal_ = 0;
}

bool OffsetFilter::has_jumped() const {
  return jump_gradient_ * jump_gradient_ > kJump * jump_normal_;
}

void OffsetFilter::predict(double elapsed_s) {
  const double kept = std::exp(-elapsed_s / kDriftMemory_s);
  Covariance transition = Covariance::Identity();
  transition(kOffset, kDrift) = kDriftMemory_s * (1 - kept);
  transition(kDrift, kDrift) = kept;
  const double swaying = std::exp(-elapsed_s / kSwayMemory_s);
  transition.diagonal().segment<3>(kSway).setConstant(swaying);
  state_ = (transition * state_).eval();
  covariance_ = (transition * covariance_ * transition.transpose()).eval();
  covariance_(kOffset, kOffset) += kOffsetWalk_s2_s * elapsed_s;
  covariance_(kDrift, kDrift) += kDriftSigma * kDriftSigma * (1 - kept * kept);
  covariance_.diagonal().segment<3>(kBias).array() += kBiasWalk_rad2_s3 * elapsed_s;
  covariance_.diagonal().segment<3>(kSway).array() +=
      scatter_ * kSwaySigma_rad_s * kSwaySigma_rad_s * (1 - swaying * swaying);
}

Verdict OffsetFilter::update(const TurnMiss& miss) {
  Eigen::Matrix<double, 3, kSize> by_state = Eigen::Matrix<double, 3, kSize>::Zero();
  by_state.col(kOffset) = miss.by_offset_rad_s;
  by_state.middleCols<3>(kBias) = miss.by_bias_s;
  by_state.middleCols<3>(kSway) = (miss.to_s - miss.from_s) * Eigen::Matrix3d::Identity();
  const double turn_rad = Eigen::AngleAxisd(miss.q_to_from).angle();
  const double model_rad2 = std::pow(kTurnShare * turn_rad, 2) + kLeastMiss_rad * kLeastMiss_rad;
  Eigen::Matrix3d noise =
      kNeighboursAlike * (miss.covariance_rad2 + model_rad2 * Eigen::Matrix3d::Identity());
  const Eigen::Vector3d left_rad =
      miss.miss_rad - by_state.middleCols<3>(kSway) * state_.segment<3>(kSway);
  const Eigen::Matrix3d known = by_state * covariance_ * by_state.transpose();
  const Eigen::Matrix3d information = (known + noise).inverse();
  const double distance_sq = left_rad.dot(information * left_rad);
  const double believed = std::min(1.0, std::sqrt(kRefused / distance_sq));
  const Eigen::Vector3d weighted = information * miss.by_offset_rad_s;
  jump_gradient_ = kJumpMemory * jump_gradient_ + believed * weighted.dot(left_rad);
  jump_normal_ = kJumpMemory * jump_normal_ + weighted.dot(miss.by_offset_rad_s);
  scatter_ =
      std::clamp(scatter_ * std::exp(std::copysign(kScatterStep, distance_sq - kMedianOfChi2)),
                 kLeastScatter, kMostScatter);
  if (!(distance_sq < kRefused)) return Verdict::disagrees;
  noise *= std::max(1.0, distance_sq / kDoubted);
  const Eigen::Matrix<double, kSize, 3> gain =
      covariance_ * by_state.transpose() * (known + noise).inverse();
  state_ += gain * left_rad;
  const Covariance rest = Covariance::Identity() - gain * by_state;
  covariance_ = (rest * covariance_ * rest.transpose() + gain * noise * gain.transpose()).eval();
  return Verdict::agrees;
}

}  // namespace gimbal

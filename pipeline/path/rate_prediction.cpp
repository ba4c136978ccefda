#include "pipeline/path/rate_prediction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

using Eigen::Vector3d;

constexpr double kMemory_s = 3.3;

/// Of the mean information, so that it does not depend on how much the hand shakes.
constexpr double kRidge = 1e-3;

/// A fit to fewer rates than these says little.
constexpr std::size_t kLeastFitted = RatePrediction::kOrder;

/// A prediction that runs away is no prediction.
constexpr double kMostOfLargest = 3;

}  // namespace

RatePrediction::RatePrediction() {
  for (Axis& axis : axes_) {
    axis.information.setZero();
    axis.vector.setZero();
  }
}

RatePrediction::History RatePrediction::history(int axis) const {
  History rates;
  for (Eigen::Index i = 0; i < kOrder; ++i) {
    rates[i] = last_rad_s_[static_cast<std::size_t>(i)][axis];
  }
  return rates;
}

void RatePrediction::push(const Vector3d& rate_rad_s, double interval_s) {
  const double kept = std::exp(-interval_s / kMemory_s);
  largest_rad_s_ = std::max(kept * largest_rad_s_, rate_rad_s.lpNorm<Eigen::Infinity>());
  if (last_rad_s_.size() == static_cast<std::size_t>(kOrder)) {
    for (int i = 0; i < 3; ++i) {
      Axis& axis = axes_[static_cast<std::size_t>(i)];
      const History rates = history(i);
      axis.information = kept * axis.information + rates * rates.transpose();
      axis.vector = kept * axis.vector + rates * rate_rad_s[i];
    }
    last_rad_s_.pop_back();
    ++fitted_;
  }
  last_rad_s_.push_front(rate_rad_s);
}

std::vector<Vector3d> RatePrediction::next(std::size_t count) const {
  std::vector<Vector3d> rates(count, Vector3d::Zero());
  if (fitted_ < kLeastFitted || count == 0) return rates;
  const double limit = kMostOfLargest * largest_rad_s_;
  for (int i = 0; i < 3; ++i) {
    const Axis& axis = axes_[static_cast<std::size_t>(i)];
    const double ridge = kRidge * axis.information.trace() / static_cast<double>(kOrder);
    if (!(ridge > 0)) continue;  // the axis never moved
    auto information = axis.information;
    information.diagonal().array() += ridge;
    const History coefficients = information.ldlt().solve(axis.vector);
    History rates_before = history(i);
    for (Vector3d& rate : rates) {
      rate[i] = std::clamp(coefficients.dot(rates_before), -limit, limit);
      std::copy_backward(rates_before.begin(), rates_before.end() - 1, rates_before.end());
      rates_before[0] = rate[i];
    }
  }
  return rates;
}

}  // namespace gimbal

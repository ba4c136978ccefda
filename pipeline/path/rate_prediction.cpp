#include "pipeline/path/rate_prediction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

using Eigen::Vector3d;

constexpr double kMemory_s = 3.3;

constexpr double kStep_s = 1 / 30.0;

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
  turned_rad_ += interval_s * rate_rad_s;
  passed_s_ += interval_s;
  const bool is_nearest = passed_s_ + interval_s / 2 >= kStep_s;
  if (!is_nearest) return;
  take_step(turned_rad_ / passed_s_, passed_s_);
  turned_rad_.setZero();
  passed_s_ = 0;
}

void RatePrediction::take_step(const Vector3d& rate_rad_s, double step_s) {
  step_s_ = step_s;
  const double kept = std::exp(-step_s / kMemory_s);
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

std::vector<Vector3d> RatePrediction::next(std::size_t count, double interval_s) const {
  std::vector<Vector3d> rates(count, Vector3d::Zero());
  if (fitted_ < kLeastFitted || count == 0) return rates;
  const auto step_at = [&](std::size_t i) {
    const double middle_s = passed_s_ + (static_cast<double>(i) + 0.5) * interval_s;
    return static_cast<std::size_t>(middle_s / step_s_);
  };
  const std::vector<Vector3d> steps = next_steps(step_at(count - 1) + 1);
  for (std::size_t i = 0; i < count; ++i) rates[i] = steps[step_at(i)];
  return rates;
}

std::vector<Vector3d> RatePrediction::next_steps(std::size_t count) const {
  std::vector<Vector3d> rates(count, Vector3d::Zero());
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

#include "pipeline/path/path_optimum.hpp"

#include <algorithm>
#include <cmath>

namespace gimbal {
namespace {

using Eigen::Vector3d;
using Limits = ViewRoom::Limits;

constexpr int kMostSteps = 12;
constexpr int kMostHalvings = 14;

/// A fortieth of a pixel at 1200 pixels a radian.
constexpr double kSmallStep_rad = 2e-5;

/// Weights of the points at times t, newest first, in the derivative of the order `order` at the
/// newest one, by divided differences: intervals need not be alike.
std::array<double, PathOptimum::kPoints> derivative(
    std::size_t order, const std::array<double, PathOptimum::kPoints>& t) {
  constexpr std::array<double, PathOptimum::kPoints> kFactorial = {1, 1, 2, 6};
  std::array<double, PathOptimum::kPoints> weights{};
  for (std::size_t i = 0; i <= order; ++i) {
    double product = 1;
    for (std::size_t j = 0; j <= order; ++j) {
      if (j != i) product *= t[i] - t[j];
    }
    weights[i] = kFactorial[order] / product;
  }
  return weights;
}

Limits use_of(const PathTarget& target, const Vector3d& view_rad) {
  return target.use + target.use_per_rad * (view_rad - target.real_turn_rad);
}

Limits beyond(const PathWall& wall, const Limits& use) {
  return (use.array() - wall.at).cwiseMax(0);
}

Vector3d overshoot(const PathTarget& target, const Vector3d& view_rad) {
  return (view_rad - target.most_rad).cwiseMax(0) - (target.least_rad - view_rad).cwiseMax(0);
}

std::size_t reach_back(std::size_t i) {
  return std::min(i, BlockBand::kReach);
}

double largest(const std::vector<Vector3d>& vectors) {
  double most = 0;
  for (const Vector3d& v : vectors) most = std::max(most, v.lpNorm<Eigen::Infinity>());
  return most;
}

}  // namespace

void PathOptimum::weigh_smoothness(double smoothing_s, Past past,
                                   std::span<const PathTarget> targets) {
  constexpr std::array<double, kOrders> kWeight = {3, 3, 1};
  const auto time = [&](std::size_t i) {
    return i < past.size() ? past[i].time_s : targets[i - past.size()].aim.time_s;
  };
  roughness_.assign(targets.size(), {});
  stiffness_.assign(targets.size(), {});
  interval_s_.resize(targets.size());
  for (std::size_t i = 0; i < past.size(); ++i) past_rad_[i] = past[i].turn_rad;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const std::array<double, kPoints> t = {time(i + 3), time(i + 2), time(i + 1), time(i)};
    interval_s_[i] = t[0] - t[1];
    double scale = std::sqrt(interval_s_[i]);
    for (std::size_t order = 1; order <= kOrders; ++order) {
      scale *= smoothing_s;
      auto& weights = roughness_[i][order - 1];
      weights = derivative(order, t);
      for (double& weight : weights) weight *= scale * std::sqrt(kWeight[order - 1]);
      for (std::size_t a = 0; a <= reach_back(i); ++a) {
        for (std::size_t b = a; b <= reach_back(i); ++b) {
          stiffness_[i - a][b - a] += weights[a] * weights[b];
        }
      }
    }
  }
}

PathOptimum::Roughness PathOptimum::roughness(std::size_t i,
                                              const std::vector<Vector3d>& views_rad) const {
  Roughness rough;
  for (std::size_t order = 0; order < kOrders; ++order) {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t back = 0; back <= order + 1; ++back) {
      const Vector3d& view = back <= i ? views_rad[i - back] : past_rad_[kOrders + i - back];
      sum += roughness_[i][order][back] * view;
    }
    rough[order] = sum;
  }
  return rough;
}

double PathOptimum::cost_of(const PathCost& cost, std::span<const PathTarget> targets,
                            const std::vector<Vector3d>& views_rad) const {
  double sum = 0;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const PathTarget& target = targets[i];
    const Vector3d& view = views_rad[i];
    for (const Vector3d& rough : roughness(i, views_rad)) sum += rough.squaredNorm();
    const Vector3d off = view - target.aim.turn_rad;
    const Limits use = use_of(target, view);
    double walls = 0;
    for (const PathWall& wall : cost.walls) walls += wall.weight * beyond(wall, use).squaredNorm();
    sum += interval_s_[i] * (target.pull * off.squaredNorm() +
                             target.axis_pull * off.dot(target.axis) * off.dot(target.axis) +
                             target.confidence * rad2_per_use2_ * walls +
                             cost.overshoot_weight * overshoot(target, view).squaredNorm());
  }
  return sum;
}

void PathOptimum::pull_smooth(std::size_t i, const std::vector<Vector3d>& views_rad) {
  const Roughness rough = roughness(i, views_rad);
  for (std::size_t back = 0; back <= reach_back(i); ++back) {
    hessian_.block(i, back).diagonal().array() += stiffness_[i][back];
    for (std::size_t order = 0; order < kOrders; ++order) {
      step_rad_[i - back] -= roughness_[i][order][back] * rough[order];
    }
  }
}

void PathOptimum::find_step(const PathCost& cost, std::span<const PathTarget> targets,
                            const std::vector<Vector3d>& views_rad) {
  hessian_.reset(targets.size());
  step_rad_.assign(targets.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const PathTarget& target = targets[i];
    pull_smooth(i, views_rad);

    const Limits use = use_of(target, views_rad[i]);
    Limits force = Limits::Zero();
    Limits stiffness = Limits::Zero();
    for (const PathWall& wall : cost.walls) {
      const double weight = interval_s_[i] * target.confidence * rad2_per_use2_ * wall.weight;
      force += weight * beyond(wall, use);
      stiffness.array() += weight * (use.array() > wall.at).cast<double>();
    }
    const Vector3d over = overshoot(target, views_rad[i]);
    const double pull = interval_s_[i] * target.pull;
    const double push_back = interval_s_[i] * cost.overshoot_weight;
    const double axis_pull = interval_s_[i] * target.axis_pull;
    const Vector3d off = views_rad[i] - target.aim.turn_rad;
    step_rad_[i] -= pull * off + axis_pull * off.dot(target.axis) * target.axis + push_back * over +
                    target.use_per_rad.transpose() * force;
    hessian_.block(i, 0).diagonal().array() +=
        pull + push_back * (over.array() != 0).cast<double>();
    hessian_.block(i, 0).noalias() += axis_pull * target.axis * target.axis.transpose();
    hessian_.block(i, 0).noalias() +=
        target.use_per_rad.transpose() * stiffness.asDiagonal() * target.use_per_rad;
  }
  hessian_.factorize();
  hessian_.solve_in_place(step_rad_);
}

void PathOptimum::find(const PathCost& cost, Past past, std::span<const PathTarget> targets,
                       std::vector<Vector3d>& views_rad) {
  weigh_smoothness(cost.smoothing_s, past, targets);
  const double use2_per_rad2 = targets[0].use_per_rad.squaredNorm() / ViewRoom::kLimits;
  rad2_per_use2_ = use2_per_rad2 > 0 ? 1 / use2_per_rad2 : 0;
  double least_cost = cost_of(cost, targets, views_rad);
  for (int steps = 0; steps < kMostSteps; ++steps) {
    find_step(cost, targets, views_rad);
    double part = 1;
    for (int halvings = 0;; ++halvings, part /= 2) {
      tried_rad_ = views_rad;
      for (std::size_t i = 0; i < tried_rad_.size(); ++i) tried_rad_[i] += part * step_rad_[i];
      const double tried_cost = cost_of(cost, targets, tried_rad_);
      if (tried_cost <= least_cost) {
        least_cost = tried_cost;
        break;
      }
      if (halvings == kMostHalvings) return;  // as good as numbers get
    }
    views_rad.swap(tried_rad_);
    if (part * largest(step_rad_) < kSmallStep_rad) return;
  }
}

}  // namespace gimbal

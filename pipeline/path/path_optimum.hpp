#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "pipeline/path/block_band.hpp"
#include "pipeline/sample/view_room.hpp"

namespace gimbal {

/// Where a camera looks at a time: a rotation vector about world axes, from a direction that all
/// points of a path share.
struct PathPoint {
  double time_s = 0;
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
};

/// What a frame asks of its view.
struct PathTarget {
  PathPoint aim;  ///< where the view is drawn to: the camera's own, or that made level
  Eigen::Vector3d real_turn_rad = Eigen::Vector3d::Zero();  ///< of the camera itself
  /// How much of the room the real camera's own view uses, and what a turn away from it adds. At 0
  /// is the middle of the room, at 1 the frame's edge.
  ViewRoom::Limits use = ViewRoom::Limits::Zero();
  Eigen::Matrix<double, ViewRoom::kLimits, 3> use_per_rad =
      Eigen::Matrix<double, ViewRoom::kLimits, 3>::Zero();
  /// Turns that the camera comes to around that time: a view beyond them would overshoot.
  Eigen::Vector3d least_rad = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
  Eigen::Vector3d most_rad = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  double pull = 1;  ///< of the aim on the view
  /// Along this direction the aim pulls with `axis_pull` more.
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double axis_pull = 0;
  double confidence = 1;  ///< of the room: less where the frame is only guessed
};

/// Costs what is used of the room beyond `at`, quadratically.
struct PathWall {
  double at = 0;
  double weight = 0;
};

struct PathCost {
  double smoothing_s = 0.5;  ///< T
  std::array<PathWall, 3> walls;
  double overshoot_weight = 0;
};

/// The smoothest path through the room that frames leave to their views:
///
///   min  integral of T^6 |y'''|^2 + 3 T^4 |y''|^2 + 3 T^2 |y'|^2 + pull |y - aim|^2 + penalties
///
/// Without penalties that is the low-pass 1 / (1 + (T omega)^2)^3, which neither rings nor lags.
/// The penalties are one-sided quadratics, so the problem is convex: Newton's method with a line
/// search, a step of which costs time in proportion to the number of frames.
class PathOptimum {
 public:
  static constexpr std::size_t kOrders = BlockBand::kReach;  ///< of derivatives that are weighed
  static constexpr std::size_t kPoints = kOrders + 1;        ///< that the last of them takes

  /// Oldest first.
  using Past = std::span<const PathPoint, kOrders>;

  /// Improves `views_rad`, one for each of `targets`, until they are the optimum or time is up.
  /// `past` are the views before, which stay as they are. All times rise strictly.
  void find(const PathCost& cost, Past past, std::span<const PathTarget> targets,
            std::vector<Eigen::Vector3d>& views_rad);

 private:
  /// The path's derivatives at a view, weighed.
  using Roughness = std::array<Eigen::Vector3d, kOrders>;

  void weigh_smoothness(double smoothing_s, Past past, std::span<const PathTarget> targets);
  [[nodiscard]] Roughness roughness(std::size_t i,
                                    const std::vector<Eigen::Vector3d>& views_rad) const;
  [[nodiscard]] double cost_of(const PathCost& cost, std::span<const PathTarget> targets,
                               const std::vector<Eigen::Vector3d>& views_rad) const;
  void find_step(const PathCost& cost, std::span<const PathTarget> targets,
                 const std::vector<Eigen::Vector3d>& views_rad);
  void pull_smooth(std::size_t i, const std::vector<Eigen::Vector3d>& views_rad);

  // What each point has in the derivatives, newest first. The cost and its slope are computed from
  // the derivatives themselves: their squares' matrix, which treats all axes alike, only leads to
  // the next step, since at the path's slow end rounding drowns it.
  std::vector<std::array<std::array<double, kPoints>, kOrders>> roughness_;
  std::vector<std::array<double, kPoints>> stiffness_;  ///< lower band
  std::array<Eigen::Vector3d, kOrders> past_rad_;
  std::vector<double> interval_s_;
  double rad2_per_use2_ = 0;

  BlockBand hessian_;
  std::vector<Eigen::Vector3d> step_rad_;
  std::vector<Eigen::Vector3d> tried_rad_;
};

}  // namespace gimbal

#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <vector>

namespace gimbal {

/// What a hand is about to do, told from what it did: each axis' rate is an autoregressive process,
/// rate_t = sum of c_j rate_(t-j), whose coefficients are fitted by least squares with a fading
/// memory and a ridge (Ljung, "System Identification", 1999, ch. 11). Steps and sway repeat, and a
/// path that knows the next half second meets them more gently. What does not repeat is predicted
/// to die away.
class RatePrediction {
 public:
  /// A second, as long as a pair of steps: what comes faster is taken together to steps of a
  /// thirtieth.
  static constexpr Eigen::Index kOrder = 30;

  RatePrediction();

  /// The mean rate, rad/s, from one frame to the next, `interval_s` later.
  void push(const Eigen::Vector3d& rate_rad_s, double interval_s);

  /// The rates of the next `count` intervals, each so long; zero until enough has been seen.
  [[nodiscard]] std::vector<Eigen::Vector3d> next(std::size_t count, double interval_s) const;

 private:
  /// Normal equations of one axis.
  struct Axis {
    Eigen::Matrix<double, kOrder, kOrder> information;
    Eigen::Matrix<double, kOrder, 1> vector;
  };
  using History = Eigen::Matrix<double, kOrder, 1>;  ///< newest first

  void take_step(const Eigen::Vector3d& rate_rad_s, double step_s);
  [[nodiscard]] History history(int axis) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> next_steps(std::size_t count) const;

  std::array<Axis, 3> axes_;
  std::deque<Eigen::Vector3d> last_rad_s_;  ///< newest first, kOrder at most
  double largest_rad_s_ = 0;                ///< fading
  std::size_t fitted_ = 0;

  // Of the step that is not full yet.
  Eigen::Vector3d turned_rad_ = Eigen::Vector3d::Zero();
  double passed_s_ = 0;
  double step_s_ = 0;  ///< of the last full one
};

}  // namespace gimbal

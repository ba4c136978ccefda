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
  /// A second at 30 fps: as long as a pair of steps. At higher rates it sees less far back.
  static constexpr Eigen::Index kOrder = 30;

  RatePrediction();

  /// The mean rate, rad/s, from one frame to the next, `interval_s` later.
  void push(const Eigen::Vector3d& rate_rad_s, double interval_s);

  /// The rates of the next `count` intervals; zero until enough has been seen.
  [[nodiscard]] std::vector<Eigen::Vector3d> next(std::size_t count) const;

 private:
  /// Normal equations of one axis.
  struct Axis {
    Eigen::Matrix<double, kOrder, kOrder> information;
    Eigen::Matrix<double, kOrder, 1> vector;
  };
  using History = Eigen::Matrix<double, kOrder, 1>;  ///< newest first

  [[nodiscard]] History history(int axis) const;

  std::array<Axis, 3> axes_;
  std::deque<Eigen::Vector3d> last_rad_s_;  ///< newest first, kOrder at most
  double largest_rad_s_ = 0;                ///< fading
  std::size_t fitted_ = 0;
};

}  // namespace gimbal

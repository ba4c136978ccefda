#include "drivers/synthetic/motion.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <utility>

#include "pipeline/sample/rotation.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kOrder = 4;  // a cubic spline blends four control points

/// Cumulative basis of the uniform cubic B-spline for the second to the fourth control point, with
/// derivatives by u, the place between two knots in [0, 1].
struct CumulativeBasis {
  std::array<double, 3> value;
  std::array<double, 3> first;
  std::array<double, 3> second;
};

CumulativeBasis cumulative_basis(double u) {
  const double u2 = u * u;
  const double u3 = u2 * u;
  return {{(5 + 3 * u - 3 * u2 + u3) / 6, (1 + 3 * u + 3 * u2 - 2 * u3) / 6, u3 / 6},
          {(1 - 2 * u + u2) / 2, (1 + 2 * u - 2 * u2) / 2, u2 / 2},
          {u - 1, 1 - 2 * u, u}};
}

std::vector<Eigen::Vector3d> steps_between(const std::vector<Eigen::Quaterniond>& q) {
  std::vector<Eigen::Vector3d> steps;
  steps.reserve(q.size() - 1);
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    steps.push_back(quaternion_log(q[i].conjugate() * q[i + 1]));
  }
  return steps;
}

}  // namespace

Motion::Motion(MotionKnots knots)
    : knots_(std::move(knots)), steps_(steps_between(knots_.q_world_camera)) {
  assert(knots_.q_world_camera.size() >= kOrder);
  assert(knots_.acceleration_m_s2.size() == knots_.q_world_camera.size());
  assert(knots_.spacing > SensorDuration::zero());
}

Motion Motion::delayed(SensorDuration delay) const {
  Motion later = *this;
  later.knots_.first += delay;
  return later;
}

SensorTime Motion::begin() const {
  return knots_.first + knots_.spacing;
}

SensorTime Motion::end() const {
  const auto intervals = static_cast<std::int64_t>(knots_.q_world_camera.size() - kOrder + 1);
  return begin() + intervals * knots_.spacing;
}

MotionState Motion::at(SensorTime time) const {
  const SensorDuration since_begin = std::clamp(time, begin(), end()) - begin();
  const auto last = knots_.q_world_camera.size() - kOrder;
  const auto i = std::min(static_cast<std::size_t>(since_begin / knots_.spacing), last);
  const double spacing_s = to_seconds(knots_.spacing);
  const double u =
      to_seconds(since_begin - static_cast<std::int64_t>(i) * knots_.spacing) / spacing_s;
  const CumulativeBasis basis = cumulative_basis(u);

  MotionState state{knots_.q_world_camera[i], Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                    knots_.acceleration_m_s2[i]};
  for (std::size_t j = 0; j < 3; ++j) {
    const Eigen::Vector3d& step = steps_[i + j];
    const Eigen::Quaterniond turn = quaternion_exp(basis.value[j] * step);
    const Eigen::Vector3d turn_rate = basis.first[j] / spacing_s * step;
    state.q_world_camera = state.q_world_camera * turn;
    state.rate_rad_s = turn.conjugate() * state.rate_rad_s;
    state.rate_derivative_rad_s2 = turn.conjugate() * state.rate_derivative_rad_s2 +
                                   state.rate_rad_s.cross(turn_rate) +
                                   basis.second[j] / (spacing_s * spacing_s) * step;
    state.rate_rad_s += turn_rate;
    state.acceleration_m_s2 +=
        basis.value[j] * (knots_.acceleration_m_s2[i + j + 1] - knots_.acceleration_m_s2[i + j]);
  }
  state.q_world_camera.normalize();
  if (time < begin() || time > end()) {
    state.rate_rad_s.setZero();
    state.rate_derivative_rad_s2.setZero();
    state.acceleration_m_s2.setZero();
  }
  return state;
}

}  // namespace gimbal

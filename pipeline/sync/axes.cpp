#include "pipeline/sync/axes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace gimbal {
namespace {

constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};

/// Which of the given axes each right one is.
using Sources = std::array<std::size_t, 3>;

Sources sources_of(const Eigen::Matrix3d& axes) {
  Sources sources{};
  for (std::size_t row = 0; row < 3; ++row) {
    Eigen::Index column = 0;
    axes.row(static_cast<Eigen::Index>(row)).cwiseAbs().maxCoeff(&column);
    sources.at(row) = static_cast<std::size_t>(column);
  }
  return sources;
}

std::string order_fault(const Sources& sources) {
  const auto name = [](std::size_t axis) { return kNames.at(axis); };
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = a + 1; b < 3; ++b) {
      if (sources.at(a) == b && sources.at(b) == a) {
        return fmt::format("{} and {} are swapped", name(a), name(b));
      }
    }
  }
  if (sources == Sources{0, 1, 2}) return "";
  return fmt::format("x is called {}, y is called {} and z is called {}", name(sources[0]),
                     name(sources[1]), name(sources[2]));
}

std::string sign_fault(const Eigen::Matrix3d& axes) {
  std::string reversed;
  int count = 0;
  for (Eigen::Index row = 0; row < 3; ++row) {
    if (axes.row(row).sum() > 0) continue;
    reversed +=
        fmt::format("{}{}", count == 0 ? "" : " and ", kNames.at(static_cast<std::size_t>(row)));
    ++count;
  }
  if (count == 0) return "";
  return fmt::format("{} {} the wrong sign", reversed, count == 1 ? "has" : "have");
}

}  // namespace

Eigen::Matrix3d nearest_axes(const Eigen::Matrix3d& orthogonal) {
  std::array<int, 3> order = {0, 1, 2};
  Eigen::Matrix3d nearest = Eigen::Matrix3d::Identity();
  double best = -1;
  do {
    double likeness = 0;
    for (int row = 0; row < 3; ++row) {
      likeness += std::abs(orthogonal(row, order.at(static_cast<std::size_t>(row))));
    }
    if (likeness <= best) continue;
    best = likeness;
    nearest.setZero();
    for (int row = 0; row < 3; ++row) {
      const int column = order.at(static_cast<std::size_t>(row));
      nearest(row, column) = orthogonal(row, column) < 0 ? -1 : 1;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return nearest;
}

std::string axes_fault(const Eigen::Matrix3d& found) {
  const std::string order = order_fault(sources_of(found));
  const std::string sign = sign_fault(found);
  return order + (order.empty() || sign.empty() ? "" : ", and ") + sign;
}

}  // namespace gimbal

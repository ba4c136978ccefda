#include "pipeline/fill/neighbour_choice.hpp"

#include <algorithm>
#include <cstdint>

#include "pipeline/warp/polygon.hpp"

namespace gimbal {
namespace {

/// Gaps are looked at in points so far apart.
constexpr int kPointsPerWidth = 48;

/// So much later a frame is worth half as much.
constexpr double kHalfAsGood_s = 0.2;

/// A second frame that shows the same counts for less than the first.
constexpr double kSecondShow = 0.25;

/// Frames that show less of all that is missing are left out.
constexpr double kLeastShare = 0.01;

std::vector<Eigen::Vector2d> points_outside(const PicturePolygon& outline_px, ImageSize picture) {
  const double step_px = static_cast<double>(picture.width) / kPointsPerWidth;
  const int rows = std::max(1, static_cast<int>(picture.height / step_px));
  std::vector<Eigen::Vector2d> points;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= kPointsPerWidth; ++column) {
      const Eigen::Vector2d point(column * (picture.width - 1.0) / kPointsPerWidth,
                                  row * (picture.height - 1.0) / rows);
      if (!contains(outline_px, point)) points.push_back(point);
    }
  }
  return points;
}

/// What a frame shows of the missing points.
std::vector<std::uint8_t> shown(const NeighbourCandidate& candidate,
                                const std::vector<Eigen::Vector2d>& points) {
  std::vector<std::uint8_t> shows;
  for (const Eigen::Vector2d& point : points) {
    shows.push_back(contains(candidate.outline_px, point) ? 1 : 0);
  }
  return shows;
}

double gain_of(const std::vector<std::uint8_t>& shows, const std::vector<int>& times_shown) {
  double gain = 0;
  for (std::size_t i = 0; i < shows.size(); ++i) {
    if (shows[i] == 0 || times_shown[i] > 1) continue;
    gain += times_shown[i] == 0 ? 1 : kSecondShow;
  }
  return gain;
}

}  // namespace

std::vector<std::size_t> choose_neighbours(ImageSize picture, const PicturePolygon& outline_px,
                                           const std::vector<NeighbourCandidate>& candidates,
                                           std::size_t most) {
  const std::vector<Eigen::Vector2d> points = points_outside(outline_px, picture);
  std::vector<std::vector<std::uint8_t>> shows;
  for (const NeighbourCandidate& candidate : candidates) {
    shows.push_back(points.empty() ? std::vector<std::uint8_t>{} : shown(candidate, points));
  }
  std::vector<int> times_shown(points.size(), 0);
  std::vector<std::size_t> chosen;
  while (chosen.size() < most) {
    double best_worth = kLeastShare * static_cast<double>(points.size());
    std::size_t best = candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double worth =
          gain_of(shows[i], times_shown) / (1 + candidates[i].apart_s / kHalfAsGood_s);
      if (worth <= best_worth) continue;
      best_worth = worth;
      best = i;
    }
    if (best == candidates.size()) break;
    chosen.push_back(best);
    for (std::size_t i = 0; i < points.size(); ++i) times_shown[i] += shows[best][i];
    shows[best].assign(points.size(), 0);
  }
  std::stable_sort(chosen.begin(), chosen.end(), [&](std::size_t a, std::size_t b) {
    return candidates[a].apart_s < candidates[b].apart_s;
  });
  return chosen;
}

}  // namespace gimbal

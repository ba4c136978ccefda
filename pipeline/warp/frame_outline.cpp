#include "pipeline/warp/frame_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "pipeline/warp/polygon.hpp"

namespace gimbal {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vector2d center_of(ImageSize size) {
  return {(size.width - 1) / 2.0, (size.height - 1) / 2.0};
}

/// Points of the outline as the camera sees them, in half output sizes from the output's centre:
/// the output at zoom z is the square |x|, |y| <= 1/z. Nothing if part of the outline is behind it.
std::optional<std::vector<Vector2d>> seen_from(const FrameOutline& outline,
                                               const Eigen::Quaterniond& q_world_camera,
                                               const OutputProjection& projection,
                                               ImageSize output_size) {
  const Vector2d center = center_of(output_size);
  auto points = pixels_of(outline, q_world_camera, projection);
  if (!points) return std::nullopt;
  for (Vector2d& point : *points) point = (point - center).cwiseQuotient(center);
  return points;
}

/// Least of max(|x|, |y|) on the segment: it is convex there, so it lies at an end or where one of
/// its linear pieces meets another.
double square_distance(const Vector2d& a, const Vector2d& b) {
  const Vector2d d = b - a;
  double least = std::min(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  const auto try_at = [&](double numerator, double denominator) {
    if (denominator == 0) return;
    const double t = numerator / denominator;
    if (t > 0 && t < 1) least = std::min(least, (a + t * d).cwiseAbs().maxCoeff());
  };
  try_at(a.y() - a.x(), d.x() - d.y());
  try_at(-a.y() - a.x(), d.x() + d.y());
  try_at(-a.x(), d.x());
  try_at(-a.y(), d.y());
  return least;
}

/// Of the picture, in half sizes, in the order of the outline.
const std::array<Vector2d, 4> kPictureCorners = {Vector2d(-1, -1), Vector2d(1, -1), Vector2d(1, 1),
                                                 Vector2d(-1, 1)};

/// From a side's first corner to its last, which begins the next side.
std::vector<std::size_t> points_of_side(const FrameOutline& outline, std::size_t side) {
  const std::size_t count = outline.rays_world.size();
  const std::size_t end = side + 1 < 4 ? outline.side_begin[side + 1] : count;
  std::vector<std::size_t> points;
  for (std::size_t i = outline.side_begin[side]; i <= end; ++i) points.push_back(i % count);
  return points;
}

struct Line {
  Vector2d outward;
  double distance;
};

/// Parallel to the chord of the points, through the innermost of them.
Line innermost_line(const std::vector<Vector2d>& points, const std::vector<std::size_t>& along) {
  const Vector2d chord = points[along.back()] - points[along.front()];
  const Vector2d outward = Vector2d(chord.y(), -chord.x()).normalized();
  double distance = kInfinity;
  for (const std::size_t i : along) distance = std::min(distance, outward.dot(points[i]));
  return {outward, distance};
}

/// How the pixel of a ray moves as the camera turns about its own axes; zero where it sees none.
Eigen::Matrix<double, 2, 3> pixels_per_turn(const OutputProjection& projection,
                                            const Vector3d& ray) {
  constexpr double kTurn_rad = 1e-4;
  Eigen::Matrix<double, 2, 3> moved = Eigen::Matrix<double, 2, 3>::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3d turn = kTurn_rad * Vector3d::Unit(axis).cross(ray);
    const auto ahead = projection.pixel_of((ray - turn).normalized());
    const auto behind = projection.pixel_of((ray + turn).normalized());
    if (ahead && behind) moved.col(axis) = (*ahead - *behind) / (2 * kTurn_rad);
  }
  return moved;
}

/// How far the curves that the sides truly are can lie inside of the chords between their points:
/// an eighth of the second differences.
double largest_sag(const FrameOutline& outline, const std::vector<Vector2d>& points) {
  double largest = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    const std::size_t begin = outline.side_begin[side];
    const std::size_t end = side + 1 < 4 ? outline.side_begin[side + 1] : points.size();
    for (std::size_t i = begin + 1; i < end; ++i) {
      const Vector2d bend = points[i - 1] - 2 * points[i] + points[(i + 1) % points.size()];
      largest = std::max(largest, bend.cwiseAbs().maxCoeff() / 8);
    }
  }
  return largest;
}

}  // namespace

FrameOutline trace_outline(const Lens& lens, ImageSize size, ReadoutDirection direction,
                           const LineOrientation& q_world_camera, int points_per_side) {
  const std::array<Vector2d, 4> corners = {Vector2d(-0.5, -0.5), Vector2d(size.width - 0.5, -0.5),
                                           Vector2d(size.width - 0.5, size.height - 0.5),
                                           Vector2d(-0.5, size.height - 0.5)};
  FrameOutline outline;
  for (std::size_t side = 0; side < corners.size(); ++side) {
    const Vector2d& from = corners[side];
    const Vector2d& to = corners[(side + 1) % corners.size()];
    outline.side_begin[side] = outline.rays_world.size();
    for (int i = 0; i + 1 < points_per_side; ++i) {
      const Vector2d pixel = from + (to - from) * i / (points_per_side - 1);
      const double line = reads_rows(direction) ? pixel.y() : pixel.x();
      if (const auto ray = lens.unproject(pixel)) {
        outline.rays_world.emplace_back((q_world_camera(line) * *ray).cast<float>());
      }
    }
  }
  return outline;
}

std::optional<std::vector<Vector2d>> pixels_of(const FrameOutline& outline,
                                               const Eigen::Quaterniond& q_world_camera,
                                               const OutputProjection& projection) {
  const Eigen::Matrix3d R_camera_world = q_world_camera.conjugate().toRotationMatrix();
  std::vector<Vector2d> points;
  points.reserve(outline.rays_world.size());
  for (const Eigen::Vector3f& ray_world : outline.rays_world) {
    const auto pixel = projection.pixel_of(R_camera_world * ray_world.cast<double>());
    if (!pixel) return std::nullopt;
    points.push_back(*pixel);
  }
  return points;
}

double required_zoom(const FrameOutline& outline, const Eigen::Quaterniond& q_world_camera,
                     const OutputProjection& unzoomed, ImageSize output_size) {
  const auto polygon = seen_from(outline, q_world_camera, unzoomed, output_size);
  if (!polygon || polygon->size() < 3 || !contains(*polygon, Vector2d::Zero())) return kInfinity;
  double least = kInfinity;
  Vector2d previous = polygon->back();
  for (const Vector2d& point : *polygon) {
    least = std::min(least, square_distance(previous, point));
    previous = point;
  }
  least -= largest_sag(outline, *polygon);
  return least > 0 ? 1 / least : kInfinity;
}

ViewRoom view_room(const FrameOutline& outline, const Quaterniond& q_world_camera,
                   const OutputProjection& unzoomed, ImageSize output_size) {
  ViewRoom room;
  const auto points = seen_from(outline, q_world_camera, unzoomed, output_size);
  if (!points || points->empty()) return room;
  const Vector2d center = center_of(output_size);
  const Eigen::Matrix3d R_camera_world = q_world_camera.conjugate().toRotationMatrix();
  Eigen::Index row = 0;
  for (std::size_t side = 0; side < 4; ++side) {
    const std::vector<std::size_t> along = points_of_side(outline, side);
    const Line line = innermost_line(*points, along);
    for (const Vector2d& corner : {kPictureCorners[side], kPictureCorners[(side + 1) % 4]}) {
      const std::size_t nearest =
          *std::min_element(along.begin(), along.end(), [&](std::size_t a, std::size_t b) {
            return ((*points)[a] - corner).squaredNorm() < ((*points)[b] - corner).squaredNorm();
          });
      const Vector3d ray = R_camera_world * outline.rays_world[nearest].cast<double>();
      room.shift_per_rad.row(row) = -line.outward.transpose() * center.cwiseInverse().asDiagonal() *
                                    pixels_per_turn(unzoomed, ray);
      room.side[row] = line.distance;
      room.corner[row] = line.outward.dot(corner);
      ++row;
    }
  }
  return room;
}

PinholeIntrinsics zoomed(const PinholeIntrinsics& intrinsics, ImageSize size, double zoom) {
  const Vector2d center = center_of(size);
  return {intrinsics.fx * zoom, intrinsics.fy * zoom,
          center.x() + (intrinsics.cx - center.x()) * zoom,
          center.y() + (intrinsics.cy - center.y()) * zoom};
}

}  // namespace gimbal

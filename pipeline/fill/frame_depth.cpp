#include "pipeline/fill/frame_depth.hpp"

#include <Eigen/Core>
#include <cmath>

#include "pipeline/warp/mesh_outline.hpp"

namespace gimbal {
namespace {

using Eigen::Vector2d;

double distance_to(const OutlineEdge& edge, const Vector2d& point) {
  const Vector2d along = edge.to - edge.from;
  const double length2 = along.squaredNorm();
  const double share =
      length2 > 0 ? std::clamp((point - edge.from).dot(along) / length2, 0.0, 1.0) : 0;
  return (edge.from + share * along - point).norm();
}

/// Nodes within `reach_px` of a stretch, along one axis; coordinates may be far outside.
struct NodeRange {
  int begin;
  int end;
};

NodeRange nodes_near(double a, double b, double reach_px, int nodes) {
  const auto node = [&](double coordinate) {
    return static_cast<int>(
        std::clamp((coordinate + 0.5) / CellGrid::kCellPx, -1.0, static_cast<double>(nodes)));
  };
  // The last node may lie closer to the one before it than all others.
  return {std::max(node(std::min(a, b) - reach_px), 0),
          std::min(node(std::max(a, b) + reach_px) + 2, nodes)};
}

/// The nearest edge's distance where one is within reach.
void take_nearer(const OutlineEdge& edge, const CellGrid& grid, float most_px, NodeField& depth) {
  const NodeRange columns = nodes_near(edge.from.x(), edge.to.x(), most_px, grid.columns() + 1);
  const NodeRange rows = nodes_near(edge.from.y(), edge.to.y(), most_px, grid.rows() + 1);
  for (int row = rows.begin; row < rows.end; ++row) {
    for (int column = columns.begin; column < columns.end; ++column) {
      const Vector2d node(grid.node_x(column), grid.node_y(row));
      float& nearest = depth[grid.node_index({column, row})];
      nearest = std::min(nearest, static_cast<float>(distance_to(edge, node)));
    }
  }
}

/// What a row of nodes crosses, and whether the frame begins or ends there.
struct Crossing {
  double x;
  int turn;
};

std::vector<Crossing> crossings_of(const std::vector<OutlineEdge>& outline, double y) {
  std::vector<Crossing> crossings;
  for (const OutlineEdge& edge : outline) {
    const bool is_down = edge.to.y() > y;
    if ((edge.from.y() > y) == is_down) continue;
    const double share = (y - edge.from.y()) / (edge.to.y() - edge.from.y());
    crossings.push_back({edge.from.x() + share * (edge.to.x() - edge.from.x()), is_down ? -1 : 1});
  }
  std::sort(crossings.begin(), crossings.end(),
            [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
  return crossings;
}

void turn_outside_negative(const std::vector<OutlineEdge>& outline, const CellGrid& grid,
                           NodeField& depth) {
  for (int row = 0; row <= grid.rows(); ++row) {
    const std::vector<Crossing> crossings = crossings_of(outline, grid.node_y(row));
    auto next = crossings.begin();
    int turns = 0;
    for (int column = 0; column <= grid.columns(); ++column) {
      while (next != crossings.end() && next->x <= grid.node_x(column)) turns += (next++)->turn;
      float& at = depth[grid.node_index({column, row})];
      if (turns == 0) at = -at;
    }
  }
}

}  // namespace

NodeField frame_depth(const WarpMesh& mesh, const CellGrid& grid, float most_px) {
  const std::vector<OutlineEdge> outline = outline_of(mesh);
  NodeField depth(grid.nodes(), most_px);
  for (const OutlineEdge& edge : outline) take_nearer(edge, grid, most_px, depth);
  turn_outside_negative(outline, grid, depth);
  return depth;
}

}  // namespace gimbal

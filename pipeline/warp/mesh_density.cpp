#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {
namespace {

// Where the map is looked at. It changes faster from line to line than along them: a hand trembles
// while lines are read, and no lens bends as quickly.
constexpr MeshDensity kProbesOfRows{8, 16};
constexpr MeshDensity kProbesOfColumns{16, 8};

/// Of the bound; the rest is for what curvature between the probes is above their second
/// differences.
constexpr double kShareOfBound = 0.75;

/// What a column of cells costs, in cells: each parts the rows of the picture once more.
constexpr int kCellsOfColumn = 64;

/// Second differences need three lines.
constexpr int kFewestCells = 2;
constexpr int kMostCells = 1000;

/// A grid of points of the exact map, and its largest second differences from cell to cell.
struct Curvature {
  double along_rows = 0;
  double along_columns = 0;
  double twist = 0;
};

Curvature curvature_of(const WarpMesh& probes) {
  const auto at = [&](int column, int row) -> Eigen::Vector2d {
    const auto index =
        static_cast<std::size_t>(std::ptrdiff_t{row} * probes.vertex_columns + column);
    return probes.vertices[index].output_px.cast<double>();
  };
  Curvature curvature;
  for (int row = 0; row < probes.vertex_rows; ++row) {
    for (int column = 0; column < probes.vertex_columns; ++column) {
      const Eigen::Vector2d here = at(column, row);
      if (column > 1) {
        const double bend = (here - 2 * at(column - 1, row) + at(column - 2, row)).norm();
        curvature.along_rows = std::max(curvature.along_rows, bend);
      }
      if (row > 1) {
        const double bend = (here - 2 * at(column, row - 1) + at(column, row - 2)).norm();
        curvature.along_columns = std::max(curvature.along_columns, bend);
      }
      if (column > 0 && row > 0) {
        const double twist =
            (here - at(column - 1, row) - at(column, row - 1) + at(column - 1, row - 1)).norm();
        curvature.twist = std::max(curvature.twist, twist);
      }
    }
  }
  return curvature;
}

int whole_cells(double cells) {
  return static_cast<int>(std::ceil(std::clamp<double>(cells, kFewestCells, kMostCells)));
}

/// What the pieces err at most, with vertices that share the error: half of what they would
/// without. A linear piece of length L errs by at most f'' L² / 8, and second differences are f''
/// times the square of the probes' distance. A cell errs most half-way along its diagonal: by the
/// sum of what its sides do, a / columns² + b / rows², and of what the twist adds, ± c / (columns
/// rows), of which the better diagonal is chosen. For vectors x and y the shorter of x + y and x -
/// y is at most √(x² + y²) long.
struct ErrorModel {
  double a;
  double b;
  double c;

  ErrorModel(const Curvature& curvature, MeshDensity probes)
      : a(curvature.along_rows * probes.columns * probes.columns / 8 / 2),
        b(curvature.along_columns * probes.rows * probes.rows / 8 / 2),
        c(curvature.twist * probes.columns * probes.rows / 4 / 2) {}

  [[nodiscard]] double error_px(MeshDensity density) const {
    const double columns = density.columns;
    const double rows = density.rows;
    return std::hypot(a / (columns * columns) + b / (rows * rows), c / (columns * rows));
  }

  /// How many rows it takes; at most kMostCells.
  [[nodiscard]] int rows_within(double bound_px, int columns) const {
    const double sides_px = a / (columns * columns);
    const double twist = c / columns;
    // (sides + b u)² + twist² u = bound², solved for u = 1 / rows².
    const double left = bound_px * bound_px - sides_px * sides_px;
    if (!(left > 0)) return kMostCells;
    const double half = sides_px * b + twist * twist / 2;
    return whole_cells(std::sqrt((half + std::sqrt(half * half + b * b * left)) / left));
  }
};

ChosenDensity density_within(const ErrorModel& model, double error_px) {
  const double bound_px = kShareOfBound * error_px;
  const int fewest_columns = whole_cells(std::sqrt(model.a / bound_px));
  MeshDensity best;
  int least_cost = std::numeric_limits<int>::max();
  for (int columns = fewest_columns; columns * kCellsOfColumn < least_cost; ++columns) {
    const int rows = model.rows_within(bound_px, columns);
    const int cost = columns * (rows + kCellsOfColumn);
    if (cost >= least_cost) continue;
    least_cost = cost;
    best = {columns, rows};
  }
  return {best, model.error_px(best) / kShareOfBound};
}

}  // namespace

ChosenDensity choose_mesh_density(const Lens& lens, ImageSize source_size,
                                  ReadoutDirection direction, const LineOrientation& q_world_camera,
                                  const VirtualCamera& camera, double error_px) {
  const MeshDensity probes = reads_rows(direction) ? kProbesOfRows : kProbesOfColumns;
  const WarpMesh mesh = build_warp_mesh(lens, source_size, direction, q_world_camera, camera,
                                        source_size, Border::crop, probes);
  const bool all_visible =
      std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                  [](const MeshVertex& vertex) { return vertex.output_px.allFinite(); });
  // Cells of which a corner cannot be seen are left out: the finer they are, the less is lost.
  if (!all_visible) return {};
  return density_within({curvature_of(mesh), probes}, error_px);
}

}  // namespace gimbal

#include "pipeline/warp/warp_mesh.hpp"

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <limits>

#include "pipeline/warp/mesh_cell.hpp"
#include "pipeline/warp/output_projection.hpp"

namespace gimbal {
namespace {

constexpr int kMaxCells = 250;  // with the ring, 253 x 253 vertices still have 16-bit indices

// Widths of the ring, as a share of the frame, from what is wanted to what a wide lens leaves.
constexpr double kRingWidths[] = {1.0, 0.75, 0.5, 0.25, 0.125, 0.0625, 0.03125};

using Lines = std::vector<double>;

/// Coordinates of the grid's lines along one axis, the outermost of the frame exactly on its edges.
Lines grid_lines(int length_px, int cells, double ring_px) {
  Lines lines;
  if (ring_px > 0) lines.push_back(-0.5 - ring_px);
  for (int i = 0; i <= cells; ++i) lines.push_back(-0.5 + length_px * (1.0 * i / cells));
  if (ring_px > 0) lines.push_back(length_px - 0.5 + ring_px);
  return lines;
}

/// For each grid line along the readout axis, the turn from the camera at that line to the virtual
/// camera.
std::vector<Eigen::Matrix3d> turns_to_virtual(const Lines& lines, int length_px,
                                              const LineOrientation& q_world_camera,
                                              const VirtualCamera& camera) {
  const Eigen::Quaterniond q_virtual_world = camera.q_world_camera.conjugate();
  std::vector<Eigen::Matrix3d> turns;
  turns.reserve(lines.size());
  for (const double line : lines) {
    const double line_in_frame = std::clamp(line, -0.5, length_px - 0.5);
    turns.push_back((q_virtual_world * q_world_camera(line_in_frame)).toRotationMatrix());
  }
  return turns;
}

Eigen::Vector2f not_visible() {
  return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
}

MeshVertex make_vertex(const Lens& lens, const Eigen::Vector2d& source_px,
                       const Eigen::Matrix3d& R_virtual_camera,
                       const OutputProjection& projection) {
  const std::optional<Eigen::Vector3d> ray = lens.unproject(source_px);
  std::optional<Eigen::Vector2d> output_px;
  if (ray) output_px = projection.pixel_of(R_virtual_camera * *ray);
  return {source_px.cast<float>(), output_px ? output_px->cast<float>() : not_visible()};
}

bool is_visible(const MeshVertex& vertex) {
  return vertex.output_px.allFinite();
}

/// Two triangles, both turning the same way.
void append_cell(WarpMesh& mesh, MeshCell cell, const FrameLines& frame) {
  const auto [top_left, top_right, bottom_left, bottom_right] = corners_of(mesh, cell);
  const auto visible = [&](int i) {
    return is_visible(mesh.vertices[static_cast<std::size_t>(i)]);
  };
  const auto append = [&](std::initializer_list<int> corners) {
    for (const int corner : corners) mesh.triangles.push_back(static_cast<std::uint16_t>(corner));
  };
  if (!visible(top_left) || !visible(top_right) || !visible(bottom_left) || !visible(bottom_right))
    return;
  if (rises(bend_of(mesh, cell, frame))) {
    append({top_left, top_right, bottom_left, top_right, bottom_right, bottom_left});
  } else {
    append({top_left, top_right, bottom_right, top_left, bottom_right, bottom_left});
  }
}

/// Cells outside of the frame first, so that the frame's own pixels win where a violent motion
/// folds the mesh over.
void append_cells(WarpMesh& mesh) {
  const int last_column = mesh.vertex_columns - 2;
  const int last_row = mesh.vertex_rows - 2;
  const FrameLines frame = frame_lines(mesh);
  const auto in_ring = [&](MeshCell cell) {
    return cell.column < frame.columns.begin || cell.column >= frame.columns.end - 1 ||
           cell.row < frame.rows.begin || cell.row >= frame.rows.end - 1;
  };
  for (const bool ring : {true, false}) {
    for (int row = 0; row <= last_row; ++row) {
      for (int column = 0; column <= last_column; ++column) {
        if (in_ring({column, row}) == ring) append_cell(mesh, {column, row}, frame);
      }
    }
  }
}

struct Grid {
  Lines x;
  Lines y;
};

Grid make_grid(ImageSize size, MeshDensity density, double ring_width) {
  const int columns = std::clamp(density.columns, 1, kMaxCells);
  const int rows = std::clamp(density.rows, 1, kMaxCells);
  return {grid_lines(size.width, columns, ring_width * size.width),
          grid_lines(size.height, rows, ring_width * size.height)};
}

std::vector<MeshVertex> make_vertices(const Lens& lens, const Grid& grid, ImageSize source_size,
                                      ReadoutDirection direction,
                                      const LineOrientation& q_world_camera,
                                      const VirtualCamera& camera) {
  const bool by_rows = reads_rows(direction);
  const std::vector<Eigen::Matrix3d> turns =
      by_rows ? turns_to_virtual(grid.y, source_size.height, q_world_camera, camera)
              : turns_to_virtual(grid.x, source_size.width, q_world_camera, camera);
  const OutputProjection projection(camera.lens, lens, camera.intrinsics);
  std::vector<MeshVertex> vertices;
  vertices.reserve(grid.x.size() * grid.y.size());
  for (std::size_t row = 0; row < grid.y.size(); ++row) {
    for (std::size_t column = 0; column < grid.x.size(); ++column) {
      const Eigen::Vector2d source_px(grid.x[column], grid.y[row]);
      vertices.push_back(make_vertex(lens, source_px, turns[by_rows ? row : column], projection));
    }
  }
  return vertices;
}

}  // namespace

WarpMesh build_warp_mesh(const Lens& lens, ImageSize source_size, ReadoutDirection direction,
                         const LineOrientation& q_world_camera, const VirtualCamera& camera,
                         ImageSize output_size, Border border, MeshDensity density) {
  WarpMesh mesh;
  mesh.source_size = source_size;
  mesh.output_size = output_size;
  mesh.border = border;
  const auto lay_grid = [&](double ring_width) {
    const Grid grid = make_grid(source_size, density, ring_width);
    mesh.vertex_columns = static_cast<int>(grid.x.size());
    mesh.vertex_rows = static_cast<int>(grid.y.size());
    mesh.vertices = make_vertices(lens, grid, source_size, direction, q_world_camera, camera);
  };
  if (!has_ring(border)) lay_grid(0);
  if (has_ring(border)) {
    for (const double ring_width : kRingWidths) {
      lay_grid(ring_width);
      if (std::all_of(mesh.vertices.begin(), mesh.vertices.end(), is_visible)) break;
    }
  }
  append_cells(mesh);
  return mesh;
}

}  // namespace gimbal

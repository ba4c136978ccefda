#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sample/virtual_camera.hpp"

namespace gimbal {

/// What is drawn where the virtual camera sees past the edge of the frame.
enum class Border : std::uint8_t {
  crop,    ///< nothing: the path and the zoom keep the view inside; what remains is black
  extend,  ///< the outermost pixels, stretched (the thesis' mesh larger than the frame)
  mirror,  ///< the picture mirrored at its edge
  black,
  blur,  ///< a blurred continuation of the picture
  fill,  ///< what frames before and after show there, and a blurred continuation where none does
};

/// Where a point of the source lies in the output. Both in pixels, whole at pixel centres.
/// `output_px` is not finite where the virtual camera cannot see the point; no triangle uses that.
struct MeshVertex {
  Eigen::Vector2f source_px;
  Eigen::Vector2f output_px;
};

/// A grid of vertices, row by row, drawn as triangles; between vertices the map is affine.
struct WarpMesh {
  ImageSize source_size;
  ImageSize output_size;
  Border border = Border::crop;
  int vertex_columns = 0;
  int vertex_rows = 0;
  std::vector<MeshVertex> vertices;
  /// Three a triangle, two triangles a cell of the grid, drawn in this order: cells outside of the
  /// frame first. Cells that reach behind the virtual camera are left out.
  std::vector<std::uint16_t> triangles;
  /// Output pixels that the affine pieces are at most off the exact map; nothing if not known.
  std::optional<double> error_px = std::nullopt;
};

/// Cells across the frame; the error of the affine pieces falls with the square of it. The default
/// stays within 0.1 px of the exact map of a pinhole lens at 720p under violent motion (10 rad/s
/// while 30 ms are read), and within 0.2 px with the distortion of a phone's lens on top.
struct MeshDensity {
  int columns = 56;
  int rows = 32;
};

/// Orientation of the camera while the given line of the frame was exposed; see RowTiming.
using LineOrientation = std::function<Eigen::Quaterniond(double line)>;

/// Thesis (2.30)-(2.32) with the orientation of every row: each vertex of a grid over the source is
/// turned from the camera as it was at the vertex's own line, `q_world_camera(line)`, to the
/// virtual camera. With extend or mirror the grid has one more ring of cells outside of the frame,
/// as wide as the frame or as much of that as the virtual camera can see; its lines are taken at
/// the frame's edge. Densities are held between 1 and 250 cells.
[[nodiscard]] WarpMesh build_warp_mesh(const Lens& lens, ImageSize source_size,
                                       ReadoutDirection direction,
                                       const LineOrientation& q_world_camera,
                                       const VirtualCamera& camera, ImageSize output_size,
                                       Border border, MeshDensity density);

/// The same mesh with its vertices moved by half of what its pieces err, so that they err as much
/// to one side at the vertices as to the other in between: at most about half as much, and nothing
/// on the whole. The outline of the frame moves by that much as well.
[[nodiscard]] WarpMesh with_shared_error(WarpMesh mesh);

struct ChosenDensity {
  MeshDensity density;
  std::optional<double> error_px;  ///< that it stays within
};

/// The density that is drawn fastest of those whose affine pieces stay within `error_px` output
/// pixels of the exact map once they share their error, for a motion that is smooth from a
/// sixteenth of the frame's lines to the next; the default one,
/// whose error is not known, where the virtual camera cannot see all of the frame.
[[nodiscard]] ChosenDensity choose_mesh_density(const Lens& lens, ImageSize source_size,
                                                ReadoutDirection direction,
                                                const LineOrientation& q_world_camera,
                                                const VirtualCamera& camera, double error_px = 0.1);

/// Pixels of the output whose centre lies outside of the source frame.
[[nodiscard]] std::int64_t count_border_pixels(const WarpMesh& mesh);

/// Where the centre of an output pixel comes from, by the mesh's own triangles; nothing if it is
/// not covered. The definition that warpers are tested against.
[[nodiscard]] std::optional<Eigen::Vector2d> source_of(const WarpMesh& mesh,
                                                       const Eigen::Vector2d& output_px);

}  // namespace gimbal

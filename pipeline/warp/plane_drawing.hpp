#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/warp/area_painter.hpp"
#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/plane_vertices.hpp"
#include "pipeline/warp/span_painter.hpp"

namespace gimbal {

/// Draws one plane of pictures through meshes on the CPU, band of rows by band of rows. Keeps its
/// memory from one picture to the next.
class PlaneDrawing {
 public:
  PlaneDrawing(Plane plane, Interpolation interpolation)
      : plane_(plane), interpolation_(interpolation) {}

  /// What is drawn from now on. `mesh`, `source` and the output's memory have to stay until it is.
  /// `black` is a pixel of the plane: luma uses the first byte.
  void begin(const WarpMesh& mesh, const VideoFrame& source, MutablePlane output,
             std::array<std::uint8_t, 2> black);

  /// Cuts the mesh into what the bands draw: to be called once, before the first of them.
  void cut();

  [[nodiscard]] int bands() const { return static_cast<int>(bands_.size()); }

  /// Different bands can be drawn in any order and on several threads at once.
  void draw(int band);

 private:
  /// A triangle.
  struct Piece {
    std::array<Trapezoid, 2> area;
    AffineMap map{};
    SampleGrid grid;

    [[nodiscard]] RowRange rows() const { return around(area[0].rows(), area[1].rows()); }
  };

  /// What a thread needs while it draws a band.
  struct Band {
    RowRange rows;
    std::vector<std::size_t> pieces;  ///< that have some of these rows
    AreaPainter area_painter;
  };

  void part_into_bands();
  void add_piece(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c);
  void paint(const Piece& piece, Band& band) const;
  void blacken(const Band& band) const;
  void blacken(Span span) const;

  Plane plane_;
  Interpolation interpolation_;
  const WarpMesh* mesh_ = nullptr;
  ChromaSiting siting_{};
  SourcePlane source_{};
  OutputPlane output_{};
  ImageSize size_;  ///< of the output plane, in pixels
  std::array<std::uint8_t, 2> black_{};
  std::vector<Piece> pieces_;
  bool is_folded_ = false;     ///< some triangle is turned over and lies on others
  bool leaves_black_ = false;  ///< some pixel may have no triangle
  std::vector<Band> bands_;
};

}  // namespace gimbal

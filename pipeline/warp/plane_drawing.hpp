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

  /// What is drawn from now on. `source` and the output's memory have to stay until it is. `black`
  /// is a pixel of the plane: luma uses the first byte.
  void begin(const WarpMesh& mesh, const VideoFrame& source, MutablePlane output,
             std::array<std::uint8_t, 2> black);

  [[nodiscard]] int bands() const { return static_cast<int>(bands_.size()); }

  /// Different bands can be drawn in any order and on several threads at once.
  void draw(int band);

 private:
  struct Piece {
    MeshTriangle triangle;
    AffineMap map;
    SampleGrid grid;
  };

  /// What a thread needs while it draws a band.
  struct Band {
    RowRange rows;
    std::vector<Span> spans;
    std::vector<std::size_t> ends;  ///< of each piece's spans
    AreaPainter area_painter;
  };

  void part_into_bands();
  void find_spans(Band& band) const;
  void paint(const Piece& piece, std::span<const Span> spans, Band& band) const;
  void blacken(const Band& band) const;
  void blacken(Span span) const;

  Plane plane_;
  Interpolation interpolation_;
  SourcePlane source_{};
  MutablePlane output_;
  ImageSize size_;  ///< of the output plane, in pixels
  std::array<std::uint8_t, 2> black_{};
  std::vector<Piece> pieces_;
  bool is_folded_ = false;  ///< some triangle is turned over and lies on others
  std::vector<Band> bands_;
};

}  // namespace gimbal

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pipeline/warp/mesh_triangle.hpp"
#include "pipeline/warp/plane_vertices.hpp"
#include "pipeline/warp/span_painter.hpp"

namespace gimbal {

/// One plane of a frame that is to be drawn through a mesh on the CPU. Its rows can be drawn in any
/// order and on several threads at once.
class PlaneDrawing {
 public:
  /// `source` and the output's memory have to stay. `black` is a pixel of the plane: luma uses the
  /// first byte.
  PlaneDrawing(const WarpMesh& mesh, Plane plane, const VideoFrame& source, MutablePlane output,
               std::array<std::uint8_t, 2> black);

  /// Of the output plane, in pixels.
  [[nodiscard]] ImageSize size() const { return size_; }

  void draw(RowRange rows) const;

 private:
  struct Piece {
    MeshTriangle triangle;
    AffineMap map;
  };

  void blacken(RowRange rows, const std::vector<Span>& spans) const;
  void blacken(Span span) const;

  Plane plane_;
  SourcePlane source_;
  MutablePlane output_;
  ImageSize size_;
  std::array<std::uint8_t, 2> black_;
  std::vector<Piece> pieces_;
  bool is_folded_ = false;  ///< some triangle is turned over and lies on others
};

}  // namespace gimbal

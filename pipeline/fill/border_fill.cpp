#include "pipeline/fill/border_fill.hpp"

#include <algorithm>
#include <utility>

#include "pipeline/fill/frame_depth.hpp"
#include "pipeline/warp/black_level.hpp"

namespace gimbal {
namespace {

/// Distances are told a little further than pictures are compared.
float most_depth_px(ImageSize picture) {
  return Composition::reach_px(picture) + 2 * CellGrid::kCellPx;
}

void copy_rows(const ConstPlane& from, const MutablePlane& to, int row_bytes, int rows) {
  for (int y = 0; y < rows; ++y) {
    std::copy_n(from.data + y * from.stride_bytes, row_bytes, to.data + y * to.stride_bytes);
  }
}

// A neighbour that lies so well is not drawn again.
constexpr float kGoodFit_px = 0.5F;
constexpr int kMostPasses = 3;

// Orientations are not further apart: what is, is something else.
constexpr float kMostMoved_px = 12;

Eigen::Vector2f held(const Eigen::Vector2f& moved_px) {
  return moved_px.cwiseMax(-kMostMoved_px).cwiseMin(kMostMoved_px);
}

WarpMesh moved(const WarpMesh& mesh, const Eigen::Vector2f& by_px) {
  WarpMesh moved = mesh;
  for (MeshVertex& vertex : moved.vertices) vertex.output_px += by_px;
  return moved;
}

int cell_at(float coordinate, int cells) {
  return static_cast<int>(
      std::clamp((coordinate + 0.5F) / CellGrid::kCellPx, 0.0F, static_cast<float>(cells - 1)));
}

}  // namespace

Result<FilledPicture> BorderFill::draw(Warper& warper, const VideoFrame& frame,
                                       const WarpMesh& mesh,
                                       std::span<const Neighbour> neighbours) {
  auto drawn = warper.warp(frame, mesh);
  if (!drawn) return tl::unexpected(drawn.error());
  if (count_border_pixels(mesh) == 0) return FilledPicture{std::move(*drawn)};
  const auto black = static_cast<float>(black_level(frame.color).luma);
  const ImageSize size = mesh.output_size;
  composition_.begin(copy_of(*drawn), black,
                     frame_depth(mesh, CellGrid(size), most_depth_px(size)));
  for (const Neighbour& neighbour : neighbours) {
    if (auto taken =
            take_from(warper, neighbour, to_seconds(neighbour.frame.stamp.time - frame.stamp.time));
        !taken)
      return tl::unexpected(taken.error());
  }
  const std::int64_t border_px = composition_.blur_the_rest();
  return FilledPicture{pool_.publish(composition_.take(), drawn->stamp, drawn->color), border_px};
}

Result<void> BorderFill::take_from(Warper& warper, const Neighbour& neighbour, double later_s) {
  Eigen::Vector2f moved_px = held(drift_.expected_px(later_s));
  for (int pass = 1;; ++pass) {
    const WarpMesh mesh = moved(neighbour.mesh, moved_px);
    const NodeField depth_px =
        frame_depth(mesh, composition_.grid(), most_depth_px(mesh.output_size));
    if (!composition_.gains_from(depth_px)) return {};
    const auto drawn = warper.warp(neighbour.frame, near_gap(mesh));
    if (!drawn) return tl::unexpected(drawn.error());
    const ShownPart shown{drawn->planes, depth_px};
    const NeighbourFit fit = composition_.fit(shown);
    const bool lies_well = fit.shift_px.norm() < kGoodFit_px;
    moved_px = held(moved_px + fit.shift_px);
    if (!lies_well && pass < kMostPasses) continue;
    drift_.learn(later_s, moved_px);
    composition_.lay_beneath(shown, fit);
    return {};
  }
}

/// The triangles that reach into cells that are wanted.
WarpMesh BorderFill::near_gap(const WarpMesh& mesh) const {
  const CellGrid& grid = composition_.grid();
  const auto is_wanted = [&](const Eigen::Vector2f& least, const Eigen::Vector2f& most) {
    for (int row = cell_at(least.y(), grid.rows()); row <= cell_at(most.y(), grid.rows()); ++row) {
      for (int column = cell_at(least.x(), grid.columns());
           column <= cell_at(most.x(), grid.columns()); ++column) {
        if (composition_.is_near_gap({column, row})) return true;
      }
    }
    return false;
  };
  WarpMesh part = mesh;
  part.triangles.clear();
  for (std::size_t i = 0; i + 2 < mesh.triangles.size(); i += 3) {
    const Eigen::Vector2f& a = mesh.vertices[mesh.triangles[i]].output_px;
    const Eigen::Vector2f& b = mesh.vertices[mesh.triangles[i + 1]].output_px;
    const Eigen::Vector2f& c = mesh.vertices[mesh.triangles[i + 2]].output_px;
    if (!is_wanted(a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c))) continue;
    const auto first = mesh.triangles.begin() + static_cast<std::ptrdiff_t>(i);
    part.triangles.insert(part.triangles.end(), first, first + 3);
  }
  return part;
}

Nv12Buffer BorderFill::copy_of(const VideoFrame& picture) {
  Nv12Buffer copy = pool_.take(picture.size);
  const ImageSize chroma = chroma_size(picture.size);
  copy_rows(picture.planes[0], copy.luma(), picture.size.width, picture.size.height);
  copy_rows(picture.planes[1], copy.chroma(), 2 * chroma.width, chroma.height);
  bytes_copied_ += std::int64_t{picture.size.width} * picture.size.height +
                   2 * std::int64_t{chroma.width} * chroma.height;
  return copy;
}

}  // namespace gimbal

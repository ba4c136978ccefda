#include "pipeline/warp/warp_input.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace gimbal {
namespace {

bool is_empty(ImageSize size) {
  return size.width <= 0 || size.height <= 0;
}

bool is_grid(const WarpMesh& mesh) {
  const auto vertices = static_cast<std::ptrdiff_t>(mesh.vertices.size());
  return mesh.vertex_columns >= 2 && mesh.vertex_rows >= 2 &&
         vertices == std::ptrdiff_t{mesh.vertex_columns} * mesh.vertex_rows;
}

bool has_picture(const VideoFrame& frame) {
  const auto is_there = [](const ConstPlane& plane) { return plane.data != nullptr; };
  if (is_empty(frame.size)) return false;
  if (!frame.native) return std::ranges::all_of(frame.planes, is_there);
  const auto& planes = frame.native->planes;
  return frame.native->format == NativeFormat::i420 ? std::ranges::all_of(planes, is_there)
                                                    : is_there(planes[0]);
}

}  // namespace

Result<void> check_warp_input(const VideoFrame& source, const WarpMesh& mesh) {
  if (!has_picture(source)) {
    return failed(fmt::format("warp: frame {} has no picture", source.stamp.index));
  }
  if (source.size != mesh.source_size) {
    return failed(fmt::format("warp: frame {} is {}x{}, but its mesh was built for {}x{}",
                              source.stamp.index, source.size.width, source.size.height,
                              mesh.source_size.width, mesh.source_size.height));
  }
  if (is_empty(mesh.output_size) || !is_grid(mesh)) {
    return failed(fmt::format("warp: the mesh of frame {} is empty", source.stamp.index));
  }
  return {};
}

}  // namespace gimbal

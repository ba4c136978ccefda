#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

enum class Plane : std::uint8_t { luma, chroma };

/// Size in pixels of one plane of an NV12 picture; a pixel of the chroma plane is a pair of bytes.
[[nodiscard]] ImageSize plane_size(ImageSize picture, Plane plane);

/// Of all planes together, without padding.
[[nodiscard]] std::int64_t nv12_bytes(ImageSize picture);

/// The mesh's vertices in the pixel coordinates of one plane, of the source's and of the output's.
/// Luma's are the mesh's own. Chroma's follow the siting, and the outline of the grid is drawn out
/// by one output pixel: a chroma sample may lie up to half a pixel outside of the luma it colours
/// (at an odd edge), and must not be missing where that luma is drawn.
[[nodiscard]] std::vector<MeshVertex> plane_vertices(const WarpMesh& mesh, Plane plane,
                                                     ChromaSiting siting);

}  // namespace gimbal

#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <vector>

#include "pipeline/lens/lens.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal::warp_scene {

/// A pinhole lens with the iPod's field of view (thesis 2.6), scaled to this size.
[[nodiscard]] Lens ipod_lens(ImageSize size);
[[nodiscard]] PinholeIntrinsics ipod_intrinsics(ImageSize size);

/// How far the view reaches past the frame.
enum class View : std::uint8_t {
  zoomed_in,   ///< by 1.15, which hides most of the border
  zoomed_out,  ///< to 0.6: much border on all sides
};

/// A camera rolled by 3 degrees that pans and tilts while its rows are read.
[[nodiscard]] WarpMesh shaky_mesh(ImageSize source, ImageSize output, Border border, View view);

/// A mesh with the given output position for every source position of a grid.
[[nodiscard]] WarpMesh mesh_of_map(
    ImageSize source, ImageSize output, Border border,
    const std::function<Eigen::Vector2d(Eigen::Vector2d)>& output_of);

/// For mesh_of_map: everything stays where it is.
[[nodiscard]] inline Eigen::Vector2d same(const Eigen::Vector2d& source) {
  return source;
}

/// Gradients, sharp edges and noise of every scale in all planes, full contrast; seeded.
[[nodiscard]] VideoFrame make_picture(ImageSize size, const ColorInfo& color);

/// A picture whose bytes are those of a scene, so that there are edges and noise in each channel.
/// `padding`: bytes between rows, which no picture may show.
[[nodiscard]] VideoFrame native_picture(NativeFormat format, ImageSize size, int padding);

/// The same picture with other distances between its rows, which may be negative.
[[nodiscard]] VideoFrame with_strides(const VideoFrame& frame, std::ptrdiff_t luma_stride,
                                      std::ptrdiff_t chroma_stride);

/// Bytes of one plane, row by row, without padding.
[[nodiscard]] std::vector<std::uint8_t> plane_bytes(const VideoFrame& frame, int plane);

/// In levels, of all bytes of two pictures of the same size.
[[nodiscard]] int largest_difference(const VideoFrame& a, const VideoFrame& b);

}  // namespace gimbal::warp_scene

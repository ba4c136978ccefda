#pragma once

#include <optional>

#include "pipeline/dma_buf/dma_buf_heap.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/warp/dma_buf_planes.hpp"
#include "pipeline/warp/dma_buf_texture.hpp"
#include "pipeline/warp/gl_fence.hpp"
#include "pipeline/warp/mesh_painter.hpp"
#include "pipeline/warp/packed_import.hpp"
#include "pipeline/warp/plane_readback.hpp"

namespace gimbal {

// How pictures get to the GPU and back. Drivers claim more than they can do, so each of these draws
// a test picture instead of asking, in the order of what is cheapest.

/// The first way of reading back that gives a small picture back as it was: buffered or direct,
/// where the version has them, or else packed. Fails where none does. Software renderers are not
/// asked for buffers, which cost them a copy and gain nothing.
[[nodiscard]] Result<Readback> choose_readback(MeshPainter& painter, int gles_version);

/// What dma-bufs take.
struct DmaBufs {
  DmaBufHeap heap;
  DmaBufTextures textures;
  GlFences fences;
};

/// The view in which pictures that lie like this are read from a dma-buf as they are; nothing where
/// none is. `painter` is for kImportedChannels.
[[nodiscard]] std::optional<PlaneView> choose_source_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                                          const PictureLayout& layout,
                                                          int gles_version, Readback readback);

/// The same for pictures of YUYV and UYVY. `painter` is for texture_channels.
[[nodiscard]] std::optional<PlaneView> choose_packed_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                                          const PackedLayout& layout,
                                                          int gles_version, Readback readback);

/// Whether a small native picture that is copied to the GPU comes out as the CPU converts it, by
/// rounding at most. `painter` is for texture_channels.
[[nodiscard]] bool converts_as_the_processor(MeshPainter& painter, NativeFormat format,
                                             int gles_version, Readback readback);

/// The view in which pictures of this size are drawn into a dma-buf of padded_layout, and come out
/// there as they were; nothing where none is. `painter` is for texture_channels.
[[nodiscard]] std::optional<PlaneView> choose_target_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                                          ImageSize picture, int gles_version);

/// Where the planes of a picture from a heap lie.
[[nodiscard]] DmaBufPicture dma_buf_picture(const Nv12Buffer& picture);

}  // namespace gimbal

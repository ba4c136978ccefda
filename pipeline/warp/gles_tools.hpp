#pragma once

#include <optional>

#include "pipeline/warp/mesh_painter.hpp"
#include "pipeline/warp/plane_readback.hpp"
#include "pipeline/warp/transfer_probe.hpp"

namespace gimbal {

/// What a warper draws with, whatever the size of the pictures. Its context has to be current when
/// it goes.
struct GlesTools {
  int gles_version;
  Readback readback;
  bool takes_native_pictures;
  MeshPainter painter;                       ///< for texture_channels
  std::optional<MeshPainter> other_painter;  ///< for kImportedChannels where these are others
  std::optional<DmaBufs> dma_bufs;           ///< where they are used

  [[nodiscard]] MeshPainter& import_painter() { return other_painter ? *other_painter : painter; }
};

}  // namespace gimbal

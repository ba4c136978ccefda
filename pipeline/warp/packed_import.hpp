#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/dma_buf_texture.hpp"
#include "pipeline/warp/plane_converter.hpp"
#include "pipeline/warp/plane_unpacker.hpp"

namespace gimbal {

/// How a picture of YUYV or UYVY lies in a dma-buf.
struct PackedLayout {
  NativeFormat format = NativeFormat::yuyv;
  ImageSize size;  ///< in pixels
  std::ptrdiff_t stride_bytes = 0;

  friend bool operator==(const PackedLayout&, const PackedLayout&) = default;
};

/// Brings such pictures to the planes of NV12 without copying them to the GPU first.
class PackedImport {
 public:
  /// `view`: `pixels` for GR88, a texel a pixel, or `packed`. Fails where the driver cannot draw
  /// into the textures that it takes.
  [[nodiscard]] static Result<PackedImport> create(PlaneView view, const PackedLayout& layout,
                                                   int gles_version);

  /// Textures of luma and chroma, values in texture_channels. Fails where the driver does not take
  /// such memory.
  [[nodiscard]] Result<std::array<GLuint, 2>> textures(DmaBufTextures& imports,
                                                       const DmaBufPlane& place);

 private:
  PackedImport(PlaneView view, const PackedLayout& layout) : view_(view), layout_(layout) {}

  [[nodiscard]] ImageSize pairs() const;

  PlaneView view_;
  PackedLayout layout_;
  std::optional<PlaneUnpacker> unpacker_;
  std::array<std::optional<PlaneConverter>, 2> converters_;
};

}  // namespace gimbal

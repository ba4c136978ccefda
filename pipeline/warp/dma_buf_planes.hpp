#pragma once

#include <array>
#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/dma_buf_texture.hpp"
#include "pipeline/warp/plane_packer.hpp"
#include "pipeline/warp/plane_readback.hpp"
#include "pipeline/warp/plane_unpacker.hpp"

namespace gimbal {

/// The planes of a picture in a dma-buf: where each begins, and its stride.
struct DmaBufPicture {
  std::array<DmaBufPlane, 2> planes;
  std::array<std::ptrdiff_t, 2> stride_bytes = {};
};

/// Pictures in dma-bufs, to be drawn from without copying them to the GPU.
class DmaBufSources {
 public:
  /// `picture`: size of the pictures. Fails where the driver cannot bring such a view to pixels.
  [[nodiscard]] static Result<DmaBufSources> create(PlaneView view, ImageSize picture,
                                                    int gles_version);

  /// Textures of luma and chroma, values in kImportedChannels.
  [[nodiscard]] Result<std::array<GLuint, 2>> textures(DmaBufTextures& imports,
                                                       const DmaBufPicture& picture);

 private:
  DmaBufSources(PlaneView view, ImageSize picture) : view_(view), picture_(picture) {}

  PlaneView view_;
  ImageSize picture_;
  std::array<std::optional<PlaneUnpacker>, 2> unpackers_;
};

/// Pictures in dma-bufs, to be drawn into without copying them back.
class DmaBufTargets {
 public:
  [[nodiscard]] static Result<DmaBufTargets> create(PlaneView view, ImageSize picture,
                                                    int gles_version);

  /// Framebuffers of luma and chroma, a texel a pixel.
  [[nodiscard]] Result<std::array<GLuint, 2>> framebuffers(DmaBufTextures& imports,
                                                           const DmaBufPicture& picture);

  /// Brings what was drawn there into the picture's memory, where that is one more step.
  [[nodiscard]] Result<void> finish(DmaBufTextures& imports, const DmaBufPicture& picture);

 private:
  /// What is drawn first where the memory cannot be drawn into a pixel a texel.
  struct Detour {
    GlTexture drawn;
    GlFramebuffer framebuffer;
    PlanePacker packer;
  };

  DmaBufTargets(PlaneView view, ImageSize picture) : view_(view), picture_(picture) {}

  PlaneView view_;
  ImageSize picture_;
  std::array<std::optional<Detour>, 2> detours_;
};

}  // namespace gimbal

#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/gles_tools.hpp"
#include "pipeline/warp/picture_pool.hpp"

namespace gimbal {

/// Where pictures of one size are drawn, and how they get from there to memory: straight into
/// dma-bufs, where the GPU does; else by reading back.
class GlesOutput {
 public:
  [[nodiscard]] static Result<GlesOutput> create(GlesTools& tools, ImageSize picture);

  /// Framebuffers of luma and chroma for the next picture.
  [[nodiscard]] std::array<GLuint, 2> begin();

  /// Once both are drawn: waits for the GPU. The frame's memory comes back when it is let go.
  [[nodiscard]] Result<VideoFrame> finish(const FrameStamp& stamp, const ColorInfo& color);

  [[nodiscard]] std::int64_t bytes_copied() const { return bytes_copied_; }

  /// In which dma-bufs are drawn into; nothing where pictures are read back.
  [[nodiscard]] std::optional<PlaneView> view() const { return view_; }

 private:
  GlesOutput(GlesTools& tools, ImageSize picture, std::array<PlaneReadback, 2> readbacks);
  void draw_into_dma_bufs();
  [[nodiscard]] std::optional<std::array<GLuint, 2>> begin_dma_buf();
  void give_up_dma_bufs();
  [[nodiscard]] Result<void> complete();

  GlesTools* tools_;
  ImageSize size_;
  std::array<PlaneReadback, 2> readbacks_;
  std::optional<PlaneView> view_;
  std::optional<DmaBufTargets> targets_;  ///< while there is a view
  PicturePool pool_;
  std::optional<Nv12Buffer> picture_;  ///< that is being drawn
  std::int64_t bytes_copied_ = 0;
};

}  // namespace gimbal

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/gles_tools.hpp"
#include "pipeline/warp/picture_pool.hpp"

namespace gimbal {

/// Where pictures of one size are drawn, and how they get from there to memory: straight into
/// dma-bufs, where the GPU does; else by reading back. Any number may be on their way.
class GlesOutput {
 public:
  using Readbacks = std::array<PlaneReadback, 2>;  ///< of luma and chroma

  /// One that is on its way.
  struct Picture {
    Nv12Buffer memory;
    std::array<GLuint, 2> framebuffers{};  ///< that luma and chroma are drawn into
    std::optional<Readbacks> readbacks;    ///< where it is read back
    std::optional<GlFence> fence;          ///< where it is drawn into its memory
  };

  [[nodiscard]] static Result<GlesOutput> create(GlesTools& tools, ImageSize picture);

  /// The next one, to be drawn.
  [[nodiscard]] Result<Picture> begin();

  /// Once both planes are drawn: gives the GPU all that is left to do.
  [[nodiscard]] Result<void> send(Picture& picture);

  /// Waits until it is in memory, which comes back when the frame is let go.
  [[nodiscard]] Result<VideoFrame> finish(Picture picture, const FrameStamp& stamp,
                                          const ColorInfo& color);

  [[nodiscard]] std::int64_t bytes_copied() const { return bytes_copied_; }

  /// In which dma-bufs are drawn into; nothing where pictures are read back.
  [[nodiscard]] std::optional<PlaneView> view() const { return view_; }

 private:
  GlesOutput(GlesTools& tools, ImageSize picture) : tools_(&tools), size_(picture) {}
  [[nodiscard]] Result<void> make_readbacks();
  void draw_into_dma_bufs();
  [[nodiscard]] std::optional<Picture> begin_dma_buf();
  void give_up_dma_bufs();
  [[nodiscard]] Result<void> complete(Picture& picture);

  GlesTools* tools_;
  ImageSize size_;
  std::vector<Readbacks> readbacks_;  ///< that no picture has
  std::optional<PlaneView> view_;
  std::optional<DmaBufTargets> targets_;  ///< while there is a view
  PicturePool pool_;
  std::int64_t bytes_copied_ = 0;
};

}  // namespace gimbal

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/gles_tools.hpp"
#include "pipeline/warp/plane_upload.hpp"

namespace gimbal {

/// Brings frames of one size to the GPU: by importing the dma-buf that they lie in, where the GPU
/// reads it as it is; else by copying.
class GlesInput {
 public:
  GlesInput(GlesTools& tools, ImageSize picture);

  struct Source {
    std::array<GLuint, 2> textures{};
    MeshPainter* painter = nullptr;  ///< that knows where these have their values
  };
  /// The textures are the frame's until the next call.
  [[nodiscard]] Source bring(const VideoFrame& frame);

  [[nodiscard]] std::int64_t bytes_copied() const { return bytes_copied_; }

  /// Of the last frame; nothing where it was copied.
  [[nodiscard]] std::optional<PlaneView> view() const { return view_; }

 private:
  /// Memory that the GPU can read or not, as was found out by drawing.
  struct KnownLayout {
    PictureLayout layout;
    std::optional<PlaneView> view;
    std::optional<DmaBufSources> sources;
  };

  [[nodiscard]] std::optional<std::array<GLuint, 2>> import(const VideoFrame& frame);
  [[nodiscard]] KnownLayout& know(const PictureLayout& layout);

  GlesTools& tools_;
  std::array<PlaneUpload, 2> uploads_;
  std::vector<KnownLayout> layouts_;
  std::optional<PlaneView> view_;
  std::int64_t bytes_copied_ = 0;
};

}  // namespace gimbal

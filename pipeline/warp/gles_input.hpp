#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/gles_tools.hpp"
#include "pipeline/warp/native_input.hpp"
#include "pipeline/warp/packed_import.hpp"
#include "pipeline/warp/plane_upload.hpp"

namespace gimbal {

/// Brings frames of one size to the GPU: by importing the dma-buf that they lie in, where the GPU
/// reads it as it is; else by copying. Native pictures are brought to planes of NV12 by the GPU.
class GlesInput {
 public:
  GlesInput(GlesTools& tools, ImageSize picture);

  struct Source {
    std::array<GLuint, 2> textures{};
    MeshPainter* painter = nullptr;  ///< that knows where these have their values
    bool is_imported = false;        ///< the frame's own memory is drawn from
  };
  /// The textures are the frame's until the next call.
  [[nodiscard]] Source bring(const VideoFrame& frame);

  [[nodiscard]] std::int64_t bytes_copied() const { return bytes_copied_; }

  /// How the last frame got there, such as "dma-buf R8+GR88", "copied" or "copied YUYV".
  [[nodiscard]] const std::string& way() const { return way_; }

 private:
  /// Memory that the GPU can read or not, as was found out by drawing.
  struct KnownLayout {
    PictureLayout layout;
    std::optional<PlaneView> view;
    std::optional<DmaBufSources> sources;
  };

  /// A format whose passes this driver draws, or does not.
  struct KnownFormat {
    NativeFormat format;
    std::optional<NativeInput> input;
  };

  /// Memory of YUYV or UYVY that the GPU can read or not.
  struct KnownPacking {
    PackedLayout layout;
    std::optional<PackedImport> import;
  };

  [[nodiscard]] Source copy(const VideoFrame& nv12);
  [[nodiscard]] std::optional<std::array<GLuint, 2>> convert(const NativePicture& native);
  [[nodiscard]] std::optional<std::array<GLuint, 2>> import(const NativePicture& native);
  [[nodiscard]] KnownPacking& know(const PackedLayout& layout);
  [[nodiscard]] KnownFormat& know(NativeFormat format);
  [[nodiscard]] std::optional<std::array<GLuint, 2>> import(const VideoFrame& frame);
  [[nodiscard]] KnownLayout& know(const PictureLayout& layout);

  GlesTools& tools_;
  ImageSize picture_;
  std::array<PlaneUpload, 2> uploads_;
  std::vector<KnownLayout> layouts_;
  std::vector<KnownPacking> packings_;
  std::vector<KnownFormat> formats_;
  std::string way_ = "copied";
  std::int64_t bytes_copied_ = 0;
};

}  // namespace gimbal

#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_format.hpp"

namespace gimbal {

/// Copies one plane of pictures into the GPU's memory, always into the same texture.
class PlaneUpload {
 public:
  /// `picture`: size of the whole pictures.
  PlaneUpload(Plane plane, ImageSize picture, int gles_version);

  /// The texture with the plane's pixels; values are in `texture_channels`.
  [[nodiscard]] GLuint upload(ConstPlane source);

 private:
  void put(ConstPlane source);

  int gles_version_;
  ImageSize size_;
  TextureFormat format_;
  GlTexture texture_;
  std::vector<std::uint8_t> rows_;  ///< a picture whose rows GL cannot take as they lie
};

}  // namespace gimbal

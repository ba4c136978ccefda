#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/in_flight.hpp"
#include "pipeline/warp/plane_format.hpp"

namespace gimbal {

/// Copies one plane of pictures into the GPU's memory. The textures take turns, so that none is
/// overwritten while a picture in flight is drawn from it.
class PlaneUpload {
 public:
  /// Of NV12, with values in texture_channels. `picture`: size of the whole pictures.
  PlaneUpload(Plane plane, ImageSize picture, int gles_version);

  /// Any bytes of such texels.
  PlaneUpload(ImageSize size, const TextureFormat& format, GLint filter, int gles_version);

  /// The texture with the plane's pixels.
  [[nodiscard]] GLuint upload(ConstPlane source);

  [[nodiscard]] ImageSize size() const { return size_; }
  [[nodiscard]] std::int64_t bytes_per_picture() const {
    return std::int64_t{size_.width} * size_.height * format_.bytes_per_pixel;
  }

 private:
  void put(ConstPlane source);

  int gles_version_;
  ImageSize size_;
  TextureFormat format_;
  GLint filter_;
  std::array<GlTexture, kMostInFlight> textures_;  ///< made when first used
  std::size_t next_ = 0;
  std::vector<std::uint8_t> rows_;  ///< a picture whose rows GL cannot take as they lie
};

}  // namespace gimbal

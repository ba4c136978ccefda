#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/pixel_buffer.hpp"
#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/plane_packer.hpp"

namespace gimbal {

/// How a plane comes back from the GPU.
enum class Readback : std::uint8_t {
  buffered,  ///< as direct, by way of memory that the GPU fills while others go on
  direct,    ///< drawn as R8 or RG8 and read as such: GLES 3, where the driver can
  packed,    ///< drawn as RGBA, packed by a second pass: everywhere
};

/// The GPU's memory that one plane of a picture is drawn into, a texel a pixel, and how it gets
/// from there to the processor.
class PlaneReadback {
 public:
  /// `picture`: size of the whole pictures. Fails where the driver cannot draw or read in this way.
  [[nodiscard]] static Result<PlaneReadback> create(Plane plane, ImageSize picture,
                                                    int gles_version, Readback readback);

  [[nodiscard]] GLuint framebuffer() const { return framebuffer_.name(); }

  /// Once the plane is drawn: gives the GPU all that is left to do, for rows that are so far apart.
  void begin(std::ptrdiff_t stride_bytes);

  /// Waits until that is done. The output's stride is the one that was begun with.
  [[nodiscard]] Result<void> finish(MutablePlane output);

 private:
  /// Rows of packed texels.
  struct Packed {
    PlanePacker packer;
    ImageSize size;
    GlTexture texture;
    GlFramebuffer framebuffer;
  };

  PlaneReadback(Plane plane, ImageSize picture, const TextureFormat& format);
  void pack(std::ptrdiff_t stride_bytes);
  void read_pixels(std::ptrdiff_t stride_bytes, std::uint8_t* to) const;
  [[nodiscard]] std::size_t bytes_spanned(std::ptrdiff_t stride_bytes) const;

  ImageSize size_;
  TextureFormat format_;
  GlTexture drawn_;
  GlFramebuffer framebuffer_;
  std::optional<Packed> packed_;
  std::optional<PixelBuffer> buffer_;
};

}  // namespace gimbal

#pragma once

#include <cstdint>
#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/plane_format.hpp"
#include "pipeline/warp/plane_packer.hpp"

namespace gimbal {

/// How a plane comes back from the GPU.
enum class Readback : std::uint8_t {
  direct,  ///< drawn as R8 or RG8 and read as such: GLES 3, where the driver can
  packed,  ///< drawn as RGBA, packed by a second pass: everywhere
};

/// The GPU's memory that one plane of pictures is drawn into, a texel a pixel, and how it gets from
/// there to the processor.
class PlaneReadback {
 public:
  /// `picture`: size of the whole pictures. Fails where the driver cannot draw or read in this way.
  [[nodiscard]] static Result<PlaneReadback> create(Plane plane, ImageSize picture,
                                                    int gles_version, Readback readback);

  [[nodiscard]] GLuint framebuffer() const { return framebuffer_.name(); }

  /// Waits until the plane is drawn.
  void read(MutablePlane output);

 private:
  PlaneReadback(Plane plane, ImageSize picture, const TextureFormat& format);
  void read_directly(MutablePlane output);

  ImageSize size_;
  TextureFormat format_;
  GlTexture drawn_;
  GlFramebuffer framebuffer_;
  std::optional<PlanePacker> packer_;
};

}  // namespace gimbal

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/sample/result.hpp"
#include "pipeline/warp/gl_objects.hpp"
#include "pipeline/warp/mesh_painter.hpp"
#include "pipeline/warp/plane_packer.hpp"
#include "pipeline/warp/plane_vertices.hpp"

namespace gimbal {

/// How a plane comes back from the GPU.
enum class Readback : std::uint8_t {
  direct,  ///< drawn as R8 or RG8 and read as such: GLES 3, where the driver can
  packed,  ///< drawn as RGBA, packed by a second pass: everywhere
};

/// One plane of an NV12 picture on the GPU: its source texture and the target it is drawn into,
/// kept from frame to frame.
class GlesPlane {
 public:
  /// Sizes are of the whole pictures. Fails where the driver cannot draw or read in this way.
  [[nodiscard]] static Result<GlesPlane> create(Plane plane, ImageSize source, ImageSize output,
                                                int gles_version, Readback readback);

  void upload(ConstPlane source);

  /// Clears the target to `background` (one or two bytes count), then draws the mesh.
  void draw(MeshPainter& painter, const WarpMesh& mesh, ChromaSiting siting,
            std::array<std::uint8_t, 2> background);

  void read(MutablePlane output);

 private:
  GlesPlane(Plane plane, ImageSize source, ImageSize output, int gles_version);
  void make_target(const TextureFormat& format);
  void read_directly(MutablePlane output);

  Plane plane_;
  int gles_version_;
  ImageSize source_size_;
  ImageSize output_size_;
  TextureFormat format_;
  GlTexture source_;
  GlTexture target_;
  GlFramebuffer framebuffer_;
  std::optional<PlanePacker> packer_;
  std::vector<std::uint8_t> rows_;  ///< a picture whose rows GL cannot take as they lie
};

/// Where textures of this version have their two values: GLES 2 has luminance and alpha.
[[nodiscard]] std::string texture_channels(int gles_version);

}  // namespace gimbal

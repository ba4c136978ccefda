#pragma once

#include <memory>
#include <string>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// Draws a frame again through a mesh. The frame's stamp and colour go through untouched.
class Warper {
 public:
  Warper() = default;
  Warper(const Warper&) = delete;
  Warper& operator=(const Warper&) = delete;
  virtual ~Warper() = default;

  /// NV12 in, NV12 of mesh.output_size out. To be called on the thread that made the warper.
  [[nodiscard]] virtual Result<VideoFrame> warp(const VideoFrame& source, const WarpMesh& mesh) = 0;

  /// For reports: "gles" or "cpu", and what draws (GL_RENDERER).
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::string renderer() const = 0;
};

/// The plain twin of the GLES warper: same mesh, bilinear, one thread.
[[nodiscard]] std::unique_ptr<Warper> make_cpu_warper();

/// Fails where there is no EGL or no usable GLES 2 or 3, or where `source` or `output` is too large
/// for the renderer.
[[nodiscard]] Result<std::unique_ptr<Warper>> make_gles_warper(ImageSize source, ImageSize output);

}  // namespace gimbal

#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/warp/interpolation.hpp"
#include "pipeline/warp/warp_mesh.hpp"

namespace gimbal {

/// Draws a frame again through a mesh. The frame's stamp and colour go through untouched.
class Warper {
 public:
  Warper() = default;
  Warper(const Warper&) = delete;
  Warper& operator=(const Warper&) = delete;
  virtual ~Warper() = default;

  // To be called, and the warper destroyed, on the thread that made the warper.

  /// NV12 or a native picture in, NV12 of mesh.output_size out; black in the frame's own range
  /// where the mesh covers nothing. To be called where no frame is in flight.
  [[nodiscard]] Result<VideoFrame> warp(const VideoFrame& source, const WarpMesh& mesh) {
    return begin(source, mesh).and_then([this] { return finish(); });
  }

  /// As `warp`, but does not wait for what draws: the frame is in flight until `finish`. Those in
  /// flight have the same sizes, and are `most_in_flight` at most. One that fails here is not in
  /// flight.
  [[nodiscard]] virtual Result<void> begin(const VideoFrame& source, const WarpMesh& mesh) = 0;

  /// The picture of the frame that has been in flight for the longest time, and there has to be
  /// one. It is not in flight any more, not even where this fails.
  [[nodiscard]] virtual Result<VideoFrame> finish() = 0;

  /// How many frames can be drawn at once; at least 1.
  [[nodiscard]] virtual std::size_t most_in_flight() const = 0;

  /// Lets go of the memory of frames that were drawn and may come again, when no more will come for
  /// some time: whoever fills it may not get new memory before.
  virtual void forget_frames() {}

  /// Whether native pictures cost it less than their conversion to NV12 costs the CPU.
  [[nodiscard]] virtual bool takes_native_pictures() const { return false; }

  /// Of all frames so far: what goes to a GPU's memory and back. What is drawn is not copied.
  [[nodiscard]] virtual std::int64_t bytes_copied() const = 0;

  /// For reports: "gles" or "cpu", and what draws (GL_RENDERER).
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] virtual std::string renderer() const = 0;

  /// How the last frame got to what draws and back, such as "in dma-buf R8+GR88, out copied"; empty
  /// where nothing has to.
  [[nodiscard]] virtual std::string_view transfers() const { return {}; }
};

/// The twin of the GLES warper without a GPU: same mesh, with the processor's vector
/// instructions. `threads` draw a frame, the caller's among them; if not given, as many as there
/// are cores, up to what pays. The picture does not depend on it.
[[nodiscard]] std::unique_ptr<Warper> make_cpu_warper(
    std::optional<int> threads = std::nullopt,
    Interpolation interpolation = Interpolation::bilinear);

/// Which versions of OpenGL ES may be used.
enum class GlesVersion : std::uint8_t {
  best,   ///< 3 if there is one, else 2
  gles2,  ///< 2 only, as on Lima and VC4
};

/// Whether pictures that lie in dma-bufs are drawn from where they lie, and drawn pictures lie in
/// dma-bufs, so that nothing is copied to the GPU and back. Where that does not work, they are
/// copied. With `always`, native pictures are wanted of software renderers, too.
enum class DmaBufUse : std::uint8_t {
  on_gpus,
  always,  ///< with software renderers, too: for tests
  never,
};

struct GlesOptions {
  Interpolation interpolation = Interpolation::bilinear;
  GlesVersion version = GlesVersion::best;
  DmaBufUse dma_bufs = DmaBufUse::on_gpus;
};

/// Draws with OpenGL ES on a context of its own. Fails where there is no EGL or no usable GLES 2 or
/// 3, or where `source` or `output` is too large for the renderer. Once the context is lost, every
/// frame fails, those in flight too: make a new warper.
[[nodiscard]] Result<std::unique_ptr<Warper>> make_gles_warper(ImageSize source, ImageSize output,
                                                               const GlesOptions& options = {});

/// Whether a GL_RENDERER draws on the CPU: Mesa's llvmpipe and softpipe, SwiftShader, or something
/// else on top of one of these. The CPU warper needs a fraction of their time.
[[nodiscard]] bool is_software_renderer(std::string_view gl_renderer);

}  // namespace gimbal

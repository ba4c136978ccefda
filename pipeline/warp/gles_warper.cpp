#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

#include "pipeline/warp/black_level.hpp"
#include "pipeline/warp/egl_context.hpp"
#include "pipeline/warp/gles_plane.hpp"
#include "pipeline/warp/mesh_painter.hpp"
#include "pipeline/warp/picture_pool.hpp"
#include "pipeline/warp/readback_probe.hpp"
#include "pipeline/warp/warp_input.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

/// The largest picture that fits both a texture and the viewport.
ImageSize largest_picture() {
  GLint texture = 0;
  std::array<GLint, 2> viewport{};
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &texture);
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport.data());
  return {std::min(texture, viewport[0]), std::min(texture, viewport[1])};
}

Result<void> check_size(std::string_view what, ImageSize size) {
  const ImageSize largest = largest_picture();
  if (size.width <= 0 || size.height <= 0) {
    return failed(fmt::format("gles: the {} is {}x{}", what, size.width, size.height));
  }
  if (size.width > largest.width || size.height > largest.height) {
    return failed(fmt::format(
        "gles: the {} of {}x{} is too large for the renderer, which takes {}x{}; scale it down or "
        "use the cpu warper",
        what, size.width, size.height, largest.width, largest.height));
  }
  return {};
}

std::int64_t nv12_bytes(ImageSize size) {
  const ImageSize chroma = chroma_size(size);
  return std::int64_t{size.width} * size.height + 2 * std::int64_t{chroma.width} * chroma.height;
}

class GlesWarper final : public Warper {
 public:
  GlesWarper(std::unique_ptr<EglContext> context, MeshPainter painter, Readback readback)
      : context_(std::move(context)), painter_(std::move(painter)), readback_(readback) {}

  ~GlesWarper() override {
    // Without our context GL calls would hit whatever context is current instead.
    if (!context_->make_current()) eglReleaseThread();
  }

  Result<VideoFrame> warp(const VideoFrame& source, const WarpMesh& mesh) override {
    if (auto checked = check_warp_input(source, mesh); !checked) {
      return tl::unexpected(checked.error());
    }
    if (auto current = context_->make_current(); !current) return tl::unexpected(current.error());
    if (auto ready = prepare(source.size, mesh.output_size); !ready) {
      return tl::unexpected(ready.error());
    }
    Nv12Buffer picture = draw(source, mesh);
    if (auto drawn = context_->check("drawing a frame"); !drawn) {
      return tl::unexpected(drawn.error());
    }
    return pool_.publish(std::move(picture), source.stamp, source.color);
  }

  [[nodiscard]] std::int64_t bytes_copied() const override { return bytes_copied_; }
  [[nodiscard]] std::string name() const override { return "gles"; }
  [[nodiscard]] std::string renderer() const override { return renderer_; }

  /// Makes the textures for these sizes, unless they are there already.
  [[nodiscard]] Result<void> prepare(ImageSize source, ImageSize output) {
    if (planes_ && source == source_size_ && output == output_size_) return {};
    planes_.reset();
    if (auto fits = check_size("frame", source); !fits) return fits;
    if (auto fits = check_size("output", output); !fits) return fits;
    auto planes = make_planes(source, output);
    if (!planes) return tl::unexpected(planes.error());
    planes_ = std::move(*planes);
    source_size_ = source;
    output_size_ = output;
    return context_->check("making textures");
  }

 private:
  struct Planes {
    GlesPlane luma;
    GlesPlane chroma;
  };

  [[nodiscard]] Result<GlesPlane> make_plane(Plane plane, ImageSize source, ImageSize output) {
    return GlesPlane::create(plane, source, output, context_->major_version(), readback_);
  }

  [[nodiscard]] Result<Planes> make_planes(ImageSize source, ImageSize output) {
    auto luma = make_plane(Plane::luma, source, output);
    if (!luma) return tl::unexpected(luma.error());
    auto chroma = make_plane(Plane::chroma, source, output);
    if (!chroma) return tl::unexpected(chroma.error());
    return Planes{std::move(*luma), std::move(*chroma)};
  }

  /// Both planes are on their way before the first is waited for.
  [[nodiscard]] Nv12Buffer draw(const VideoFrame& source, const WarpMesh& mesh) {
    const BlackLevel black = black_level(source.color);
    const ChromaSiting siting = source.color.chroma_siting;
    planes_->luma.upload(source.planes[0]);
    planes_->chroma.upload(source.planes[1]);
    planes_->luma.draw(painter_, mesh, siting, {black.luma, 0});
    planes_->chroma.draw(painter_, mesh, siting, black.chroma);
    Nv12Buffer picture = pool_.take(mesh.output_size);
    planes_->luma.read(picture.luma());
    planes_->chroma.read(picture.chroma());
    bytes_copied_ += nv12_bytes(source.size) + nv12_bytes(mesh.output_size);
    return picture;
  }

  std::unique_ptr<EglContext> context_;  // outlives what is made in it
  std::string renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  MeshPainter painter_;
  Readback readback_;
  ImageSize source_size_;
  ImageSize output_size_;
  std::optional<Planes> planes_;
  PicturePool pool_;
  std::int64_t bytes_copied_ = 0;
};

}  // namespace

bool is_software_renderer(std::string_view gl_renderer) {
  constexpr std::array<std::string_view, 4> kNames = {"llvmpipe", "softpipe", "swiftshader",
                                                      "software rasterizer"};
  std::string renderer(gl_renderer);
  std::transform(renderer.begin(), renderer.end(), renderer.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::any_of(kNames.begin(), kNames.end(), [&](std::string_view name) {
    return renderer.find(name) != std::string::npos;
  });
}

Result<std::unique_ptr<Warper>> make_gles_warper(ImageSize source, ImageSize output,
                                                 Interpolation interpolation, GlesVersion version) {
  auto context = EglContext::create(version);
  if (!context) return tl::unexpected(context.error());
  glDisable(GL_DITHER);  // on by default, and would add noise to the picture
  const int gles_version = (*context)->major_version();
  auto painter = MeshPainter::create(texture_channels(gles_version), interpolation);
  if (!painter) return tl::unexpected(painter.error());
  const auto readback = choose_readback(*painter, gles_version);
  if (!readback) return tl::unexpected(readback.error());
  auto warper = std::make_unique<GlesWarper>(std::move(*context), std::move(*painter), *readback);
  if (auto ready = warper->prepare(source, output); !ready) return tl::unexpected(ready.error());
  return warper;
}

}  // namespace gimbal

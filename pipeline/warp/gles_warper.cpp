#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "pipeline/warp/black_level.hpp"
#include "pipeline/warp/draw_plane.hpp"
#include "pipeline/warp/egl_context.hpp"
#include "pipeline/warp/gles_input.hpp"
#include "pipeline/warp/gles_output.hpp"
#include "pipeline/warp/gles_tools.hpp"
#include "pipeline/warp/in_flight.hpp"
#include "pipeline/warp/plane_format.hpp"
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

class GlesWarper final : public Warper {
 public:
  GlesWarper(std::unique_ptr<EglContext> context, GlesTools tools)
      : context_(std::move(context)), tools_(std::move(tools)) {}

  ~GlesWarper() override {
    // Without our context GL calls would hit whatever context is current instead.
    if (!context_->make_current()) eglReleaseThread();
  }

  [[nodiscard]] std::size_t most_in_flight() const override { return kMostInFlight; }

  Result<void> begin(const VideoFrame& source, const WarpMesh& mesh) override {
    if (auto checked = check_warp_input(source, mesh); !checked) return checked;
    if (auto current = context_->make_current(); !current) return current;
    if (auto ready = prepare(source.size, mesh.output_size); !ready) return ready;
    auto drawing = draw(source, mesh);
    if (auto checked = context_->check("drawing a frame"); !checked) return checked;
    if (!drawing) return tl::unexpected(drawing.error());
    in_flight_.push_back(*std::move(drawing));
    return {};
  }

  Result<VideoFrame> finish() override {
    Drawing drawing = std::move(in_flight_.front());
    in_flight_.pop_front();
    if (auto current = context_->make_current(); !current) return tl::unexpected(current.error());
    auto drawn = output_->finish(std::move(drawing.picture), drawing.stamp, drawing.color);
    if (auto checked = context_->check("reading a picture"); !checked) {
      return tl::unexpected(checked.error());
    }
    return drawn;
  }

  void forget_frames() override {
    if (tools_.dma_bufs && context_->make_current()) tools_.dma_bufs->textures.forget_all();
  }

  [[nodiscard]] std::int64_t bytes_copied() const override {
    return bytes_copied_before_ + (input_ ? input_->bytes_copied() : 0) +
           (output_ ? output_->bytes_copied() : 0);
  }
  [[nodiscard]] bool takes_native_pictures() const override { return tools_.takes_native_pictures; }
  [[nodiscard]] std::string name() const override { return "gles"; }
  [[nodiscard]] std::string renderer() const override { return renderer_; }
  [[nodiscard]] std::string_view transfers() const override { return transfers_; }

  /// Makes the textures for these sizes, unless they are there already.
  [[nodiscard]] Result<void> prepare(ImageSize source, ImageSize output) {
    if (input_ && source == source_size_ && output == output_size_) return {};
    if (!in_flight_.empty()) return failed("gles: frames of another size are still being drawn");
    bytes_copied_before_ = bytes_copied();
    input_.reset();
    output_.reset();
    forget_frames();
    if (auto fits = check_size("frame", source); !fits) return fits;
    if (auto fits = check_size("output", output); !fits) return fits;
    auto target = GlesOutput::create(tools_, output);
    if (!target) return tl::unexpected(target.error());
    output_.emplace(std::move(*target));
    input_.emplace(tools_, source);
    source_size_ = source;
    output_size_ = output;
    return context_->check("making textures");
  }

 private:
  /// A frame that the GPU was given.
  struct Drawing {
    FrameStamp stamp;
    ColorInfo color;
    std::shared_ptr<const void> memory;  ///< that the GPU reads the frame from
    GlesOutput::Picture picture;
  };

  [[nodiscard]] Result<Drawing> draw(const VideoFrame& frame, const WarpMesh& mesh) {
    const BlackLevel black = black_level(frame.color);
    const ChromaSiting siting = frame.color.chroma_siting;
    const GlesInput::Source source = input_->bring(frame);
    auto picture = output_->begin();
    if (!picture) return tl::unexpected(picture.error());
    const auto& targets = picture->framebuffers;
    draw_plane(*source.painter, mesh, Plane::luma, siting, {black.luma, 0},
               {source.textures[0], targets[0]});
    draw_plane(*source.painter, mesh, Plane::chroma, siting, black.chroma,
               {source.textures[1], targets[1]});
    if (auto sent = output_->send(*picture); !sent) return tl::unexpected(sent.error());
    tell_transfers();
    if (tools_.dma_bufs) tools_.dma_bufs->textures.forget_unused();
    return Drawing{frame.stamp, frame.color, source.is_imported ? frame.storage : nullptr,
                   *std::move(picture)};
  }

  /// Makes the text only where something has changed.
  void tell_transfers() {
    const auto view = output_->view();
    if (!transfers_.empty() && input_->way() == way_in_ && view == view_out_) return;
    way_in_ = input_->way();
    view_out_ = view;
    transfers_ = fmt::format("in {}, out {}", way_in_, view ? dma_buf_text(*view) : "copied");
  }

  std::unique_ptr<EglContext> context_;  // outlives what is made in it
  std::string renderer_ = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  GlesTools tools_;
  ImageSize source_size_;
  ImageSize output_size_;
  std::optional<GlesInput> input_;
  std::optional<GlesOutput> output_;
  std::deque<Drawing> in_flight_;
  std::string way_in_;  ///< of the last frame, as is the view
  std::optional<PlaneView> view_out_;
  std::string transfers_;                 ///< these as text
  std::int64_t bytes_copied_before_ = 0;  ///< with sizes that are gone
};

bool draws_on_a_gpu() {
  return !is_software_renderer(reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
}

bool are_dma_bufs_used(DmaBufUse use) {
  // A software renderer gains nothing by them, and some end the process when they meet another
  // device's.
  return use == DmaBufUse::always || (use == DmaBufUse::on_gpus && draws_on_a_gpu());
}

/// A software renderer draws a conversion in several times the time of vector instructions.
bool pay_native_pictures(DmaBufUse use) {
  return use == DmaBufUse::always || draws_on_a_gpu();
}

/// Nothing where this machine or this driver has none: then pictures are copied.
std::optional<DmaBufs> open_dma_bufs(const EglDisplay& display) {
  auto heap = DmaBufHeap::open();
  if (!heap) return std::nullopt;
  auto textures = DmaBufTextures::create(display);
  if (!textures) return std::nullopt;
  return DmaBufs{std::move(*heap), std::move(*textures), GlFences(display)};
}

Result<GlesTools> make_tools(const EglContext& context, const GlesOptions& options) {
  const int gles_version = context.major_version();
  auto painter = MeshPainter::create(texture_channels(gles_version), options.interpolation);
  if (!painter) return tl::unexpected(painter.error());
  const auto readback = choose_readback(*painter, gles_version);
  if (!readback) return tl::unexpected(readback.error());
  GlesTools tools = {gles_version,        *readback,    pay_native_pictures(options.dma_bufs),
                     std::move(*painter), std::nullopt, std::nullopt};
  if (!are_dma_bufs_used(options.dma_bufs)) return tools;
  tools.dma_bufs = open_dma_bufs(context.display());
  if (!tools.dma_bufs || texture_channels(gles_version) == kImportedChannels) return tools;
  auto other = MeshPainter::create(kImportedChannels, options.interpolation);
  if (other) {
    tools.other_painter = std::move(*other);
  } else {
    tools.dma_bufs.reset();
  }
  return tools;
}

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
                                                 const GlesOptions& options) {
  auto context = EglContext::create(options.version);
  if (!context) return tl::unexpected(context.error());
  glDisable(GL_DITHER);  // on by default, and would add noise to the picture
  auto tools = make_tools(**context, options);
  if (!tools) return tl::unexpected(tools.error());
  auto warper = std::make_unique<GlesWarper>(std::move(*context), std::move(*tools));
  if (auto ready = warper->prepare(source, output); !ready) return tl::unexpected(ready.error());
  return warper;
}

}  // namespace gimbal

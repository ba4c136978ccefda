#include "pipeline/warp/transfer_probe.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pipeline/pixels/nv12_frame.hpp"
#include "pipeline/warp/draw_plane.hpp"
#include "pipeline/warp/native_input.hpp"
#include "pipeline/warp/plane_upload.hpp"
#include "pipeline/warp/test_pattern.hpp"
#include "pipeline/warp/warper.hpp"

namespace gimbal {
namespace {

constexpr ImageSize kSmallPicture{13, 6};  // odd, and no multiple of what is packed into a texel
constexpr std::array kPlanes = {Plane::luma, Plane::chroma};
constexpr std::array kViews = {PlaneView::pixels, PlaneView::bytes, PlaneView::packed};
constexpr std::array kPackedViews = {PlaneView::pixels, PlaneView::packed};

ConstPlane read_only(MutablePlane plane) {
  return {plane.data, plane.stride_bytes};
}

/// What an unusable format left behind must not be laid to the next drawing. A lost context reports
/// errors without end.
void forget_errors() {
  for (int i = 0; i < 8 && glGetError() != GL_NO_ERROR; ++i) {
  }
}

void draw_as_it_is(MeshPainter& painter, ImageSize size, Plane plane, PlaneRoute route) {
  draw_plane(painter, identity_mesh(size), plane, ChromaSiting::left, {0, 0}, route);
}

bool reads_pattern(PlaneReadback& drawn, Plane plane, ImageSize size) {
  const Nv12Buffer picture(size);
  const MutablePlane memory = plane_of(picture, plane);
  drawn.begin(memory.stride_bytes);
  return drawn.finish(memory) && shows_pattern(read_only(memory), size, plane);
}

bool reads_back(MeshPainter& painter, Plane plane, int gles_version, Readback readback) {
  auto drawn = PlaneReadback::create(plane, kSmallPicture, gles_version, readback);
  if (!drawn) return false;
  const Nv12Buffer picture(kSmallPicture);
  draw_pattern(plane_of(picture, plane), kSmallPicture, plane);
  PlaneUpload upload(plane, kSmallPicture, gles_version);
  draw_as_it_is(painter, kSmallPicture, plane,
                {upload.upload(read_only(plane_of(picture, plane))), drawn->framebuffer()});
  return reads_pattern(*drawn, plane, kSmallPicture) && glGetError() == GL_NO_ERROR;
}

bool reads_dma_buf(DmaBufs& dma_bufs, MeshPainter& painter, const Nv12Buffer& pattern,
                   PlaneView view, int gles_version, Readback readback) {
  const ImageSize size = pattern.size();
  auto sources = DmaBufSources::create(view, size, gles_version);
  if (!sources) return false;
  const auto textures = sources->textures(dma_bufs.textures, dma_buf_picture(pattern));
  if (!textures) return false;
  for (const Plane plane : kPlanes) {
    auto drawn = PlaneReadback::create(plane, size, gles_version, readback);
    if (!drawn) return false;
    draw_as_it_is(painter, size, plane,
                  {(*textures)[static_cast<std::size_t>(plane)], drawn->framebuffer()});
    if (!reads_pattern(*drawn, plane, size)) return false;
  }
  return glGetError() == GL_NO_ERROR;
}

/// A picture of that layout whose bytes are the pattern's; nothing where there is no memory.
std::optional<Nv12Buffer> packed_pattern(const DmaBufHeap& heap, const PackedLayout& layout) {
  // The luma of a picture as wide as the rows are long.
  const ImageSize bytes = {4 * chroma_size(layout.size).width, layout.size.height};
  if (layout.stride_bytes < bytes.width) return std::nullopt;
  auto memory = heap.allocate(
      {bytes, layout.stride_bytes, layout.stride_bytes, layout.stride_bytes * bytes.height});
  if (!memory) return std::nullopt;
  begin_writing(*memory);
  draw_pattern(memory->luma(), bytes, Plane::luma);
  end_writing(*memory);
  return *std::move(memory);
}

VideoFrame converted(const Nv12Buffer& packed, const PackedLayout& layout) {
  VideoFrame frame;
  frame.size = layout.size;
  frame.native = NativePicture{layout.format, {read_only(packed.luma())}};
  begin_reading(packed);
  VideoFrame nv12 = as_nv12(frame);
  end_reading(packed);
  return nv12;
}

/// Whether the textures of a picture in NV12 show it.
bool show(const std::array<GLuint, 2>& textures, const VideoFrame& nv12, MeshPainter& painter,
          int gles_version, Readback readback) {
  for (const Plane plane : kPlanes) {
    const auto index = static_cast<std::size_t>(plane);
    auto drawn = PlaneReadback::create(plane, nv12.size, gles_version, readback);
    if (!drawn) return false;
    draw_as_it_is(painter, nv12.size, plane, {textures[index], drawn->framebuffer()});
    const Nv12Buffer result(nv12.size);
    const MutablePlane memory = plane_of(result, plane);
    drawn->begin(memory.stride_bytes);
    if (!drawn->finish(memory) ||
        !are_alike(read_only(memory), nv12.planes[index], nv12.size, plane)) {
      return false;
    }
  }
  return glGetError() == GL_NO_ERROR;
}

bool reads_packed(DmaBufs& dma_bufs, MeshPainter& painter, const Nv12Buffer& pattern,
                  const PackedLayout& layout, PlaneView view, int gles_version, Readback readback) {
  auto import = PackedImport::create(view, layout, gles_version);
  if (!import) return false;
  const auto textures = import->textures(dma_bufs.textures, (*pattern.dma_buf())[0]);
  return textures && show(*textures, converted(pattern, layout), painter, gles_version, readback);
}

bool draws_dma_buf(DmaBufs& dma_bufs, MeshPainter& painter, const Nv12Buffer& picture,
                   PlaneView view, int gles_version) {
  const ImageSize size = picture.size();
  auto targets = DmaBufTargets::create(view, size, gles_version);
  if (!targets) return false;
  const DmaBufPicture memory = dma_buf_picture(picture);
  const auto framebuffers = targets->framebuffers(dma_bufs.textures, memory);
  if (!framebuffers) return false;
  const Nv12Buffer pattern(size);
  for (const Plane plane : kPlanes) {
    draw_pattern(plane_of(pattern, plane), size, plane);
    PlaneUpload upload(plane, size, gles_version);
    draw_as_it_is(painter, size, plane,
                  {upload.upload(read_only(plane_of(pattern, plane))),
                   (*framebuffers)[static_cast<std::size_t>(plane)]});
  }
  if (!targets->finish(dma_bufs.textures, memory) || !dma_bufs.fences.insert().wait()) return false;
  begin_reading(picture);
  const bool is_drawn = shows_pattern(read_only(picture.luma()), size, Plane::luma) &&
                        shows_pattern(read_only(picture.chroma()), size, Plane::chroma);
  end_reading(picture);
  return is_drawn && glGetError() == GL_NO_ERROR;
}

/// The first of the views that `works`. Nothing of the test pictures is kept.
template <typename Works>
std::optional<PlaneView> first_view(std::span<const PlaneView> views, DmaBufs& dma_bufs,
                                    Works&& works) {
  for (const PlaneView view : views) {
    const bool is_usable = works(view);
    dma_bufs.textures.forget_all();
    forget_errors();
    if (is_usable) return view;
  }
  return std::nullopt;
}

}  // namespace

DmaBufPicture dma_buf_picture(const Nv12Buffer& picture) {
  return {*picture.dma_buf(), {picture.luma().stride_bytes, picture.chroma().stride_bytes}};
}

Result<Readback> choose_readback(MeshPainter& painter, int gles_version) {
  const bool is_software =
      is_software_renderer(reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  for (const Readback readback : {Readback::buffered, Readback::direct, Readback::packed}) {
    if (readback != Readback::packed && gles_version < 3) continue;
    if (readback == Readback::buffered && is_software) continue;
    const bool works = reads_back(painter, Plane::luma, gles_version, readback) &&
                       reads_back(painter, Plane::chroma, gles_version, readback);
    forget_errors();
    if (works) return readback;
  }
  return failed(
      "gles: the driver does not give a test picture back as it was drawn; update the driver or "
      "use the cpu warper");
}

std::optional<PlaneView> choose_source_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                            const PictureLayout& layout, int gles_version,
                                            Readback readback) {
  const auto pattern = dma_bufs.heap.allocate(layout);
  if (!pattern) return std::nullopt;
  begin_writing(*pattern);
  for (const Plane plane : kPlanes) draw_pattern(plane_of(*pattern, plane), layout.size, plane);
  end_writing(*pattern);
  return first_view(kViews, dma_bufs, [&](PlaneView view) {
    return reads_dma_buf(dma_bufs, painter, *pattern, view, gles_version, readback);
  });
}

std::optional<PlaneView> choose_packed_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                            const PackedLayout& layout, int gles_version,
                                            Readback readback) {
  const auto pattern = packed_pattern(dma_bufs.heap, layout);
  if (!pattern) return std::nullopt;
  return first_view(kPackedViews, dma_bufs, [&](PlaneView view) {
    return reads_packed(dma_bufs, painter, *pattern, layout, view, gles_version, readback);
  });
}

bool converts_as_the_processor(MeshPainter& painter, NativeFormat format, int gles_version,
                               Readback readback) {
  auto input = NativeInput::create(format, kSmallPicture, gles_version);
  if (!input) return false;
  constexpr ImageSize kBytes{64, 3 * kSmallPicture.height};  // a third for each plane
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(kBytes.width * kBytes.height));
  draw_pattern({bytes.data(), kBytes.width}, kBytes, Plane::luma);
  VideoFrame pattern;
  pattern.size = kSmallPicture;
  NativePicture& native = pattern.native.emplace();
  native.format = format;
  for (std::size_t i = 0; i < native.planes.size(); ++i) {
    native.planes[i] = {bytes.data() + i * bytes.size() / native.planes.size(), kBytes.width};
  }
  const bool is_alike =
      show(input->bring(native.planes), as_nv12(pattern), painter, gles_version, readback);
  forget_errors();
  return is_alike;
}

std::optional<PlaneView> choose_target_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                            ImageSize picture, int gles_version) {
  const PictureLayout layout = padded_layout(picture);
  return first_view(kViews, dma_bufs, [&](PlaneView view) {
    // Each its own memory, or what one view has drawn would be found by the next.
    const auto memory = dma_bufs.heap.allocate(layout);
    return memory && draws_dma_buf(dma_bufs, painter, *memory, view, gles_version);
  });
}

}  // namespace gimbal

#include "pipeline/warp/transfer_probe.hpp"

#include <array>
#include <cstddef>
#include <utility>

#include "pipeline/warp/draw_plane.hpp"
#include "pipeline/warp/plane_upload.hpp"
#include "pipeline/warp/test_pattern.hpp"

namespace gimbal {
namespace {

constexpr ImageSize kSmallPicture{13, 6};  // odd, and no multiple of what is packed into a texel
constexpr std::array kPlanes = {Plane::luma, Plane::chroma};
constexpr std::array kViews = {PlaneView::pixels, PlaneView::bytes, PlaneView::packed};

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

bool reads_back(MeshPainter& painter, Plane plane, int gles_version, Readback readback) {
  auto drawn = PlaneReadback::create(plane, kSmallPicture, gles_version, readback);
  if (!drawn) return false;
  const Nv12Buffer picture(kSmallPicture);
  draw_pattern(plane_of(picture, plane), kSmallPicture, plane);
  PlaneUpload upload(plane, kSmallPicture, gles_version);
  draw_as_it_is(painter, kSmallPicture, plane,
                {upload.upload(read_only(plane_of(picture, plane))), drawn->framebuffer()});
  const Nv12Buffer result(kSmallPicture);
  drawn->read(plane_of(result, plane));
  return glGetError() == GL_NO_ERROR &&
         shows_pattern(read_only(plane_of(result, plane)), kSmallPicture, plane);
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
    const Nv12Buffer result(size);
    drawn->read(plane_of(result, plane));
    if (!shows_pattern(read_only(plane_of(result, plane)), size, plane)) return false;
  }
  return glGetError() == GL_NO_ERROR;
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
  if (!targets->finish(dma_bufs.textures, memory) || !dma_bufs.fence.wait()) return false;
  begin_reading(picture);
  const bool is_drawn = shows_pattern(read_only(picture.luma()), size, Plane::luma) &&
                        shows_pattern(read_only(picture.chroma()), size, Plane::chroma);
  end_reading(picture);
  return is_drawn && glGetError() == GL_NO_ERROR;
}

/// The first view that `works`. Nothing of the test pictures is kept.
template <typename Works>
std::optional<PlaneView> first_view(DmaBufs& dma_bufs, Works&& works) {
  for (const PlaneView view : kViews) {
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
  for (const Readback readback : {Readback::direct, Readback::packed}) {
    if (readback == Readback::direct && gles_version < 3) continue;
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
  return first_view(dma_bufs, [&](PlaneView view) {
    return reads_dma_buf(dma_bufs, painter, *pattern, view, gles_version, readback);
  });
}

std::optional<PlaneView> choose_target_view(DmaBufs& dma_bufs, MeshPainter& painter,
                                            ImageSize picture, int gles_version) {
  const PictureLayout layout = padded_layout(picture);
  return first_view(dma_bufs, [&](PlaneView view) {
    // Each its own memory, or what one view has drawn would be found by the next.
    const auto memory = dma_bufs.heap.allocate(layout);
    return memory && draws_dma_buf(dma_bufs, painter, *memory, view, gles_version);
  });
}

}  // namespace gimbal

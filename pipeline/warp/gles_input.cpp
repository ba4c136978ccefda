#include "pipeline/warp/gles_input.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pipeline/pixels/nv12_frame.hpp"

namespace gimbal {
namespace {

bool is_same_memory(int a, int b) {
  struct stat first {};
  struct stat second {};
  return a == b || (::fstat(a, &first) == 0 && ::fstat(b, &second) == 0 &&
                    first.st_ino == second.st_ino && first.st_dev == second.st_dev);
}

/// Where a memory of its own begins, all GPUs let a plane begin.
constexpr std::ptrdiff_t kPlaneStep_bytes = 4096;

/// As a picture in one memory, for a test picture; nothing where chroma does not follow on luma.
std::optional<PictureLayout> layout_of(const VideoFrame& frame) {
  const auto& [luma, chroma] = *frame.dma_buf;
  PictureLayout layout = {frame.size, frame.planes[0].stride_bytes, frame.planes[1].stride_bytes};
  const std::ptrdiff_t luma_bytes = layout.luma_stride_bytes * frame.size.height;
  layout.chroma_offset_bytes = is_same_memory(luma.fd, chroma.fd)
                                   ? chroma.offset_bytes - luma.offset_bytes
                                   : (luma_bytes / kPlaneStep_bytes + 1) * kPlaneStep_bytes;
  if (layout.luma_stride_bytes < frame.size.width) return std::nullopt;
  if (layout.chroma_offset_bytes < luma_bytes) return std::nullopt;
  return layout;
}

}  // namespace

GlesInput::GlesInput(GlesTools& tools, ImageSize picture)
    : tools_(tools),
      picture_(picture),
      uploads_{PlaneUpload(Plane::luma, picture, tools.gles_version),
               PlaneUpload(Plane::chroma, picture, tools.gles_version)} {}

GlesInput::Source GlesInput::bring(const VideoFrame& frame) {
  if (!frame.native) {
    if (const auto textures = import(frame)) return {*textures, &tools_.import_painter(), true};
    return copy(frame);
  }
  if (const auto textures = import(*frame.native)) return {*textures, &tools_.painter, true};
  if (const auto textures = convert(*frame.native)) return {*textures, &tools_.painter, false};
  return copy(as_nv12(frame));
}

GlesInput::Source GlesInput::copy(const VideoFrame& nv12) {
  way_ = "copied";
  bytes_copied_ += nv12_bytes(nv12.size);
  return {{uploads_[0].upload(nv12.planes[0]), uploads_[1].upload(nv12.planes[1])},
          &tools_.painter,
          false};
}

std::optional<std::array<GLuint, 2>> GlesInput::convert(const NativePicture& native) {
  KnownFormat& known = know(native.format);
  if (!known.input) return std::nullopt;
  way_ = "copied " + std::string(name_of(native.format));
  bytes_copied_ += known.input->bytes_per_picture();
  return known.input->bring(native.planes);
}

std::optional<std::array<GLuint, 2>> GlesInput::import(const NativePicture& native) {
  const bool is_packed = native.format == NativeFormat::yuyv || native.format == NativeFormat::uyvy;
  if (!tools_.dma_bufs || !native.dma_buf || !is_packed) return std::nullopt;
  KnownPacking& known = know({native.format, picture_, native.planes[0].stride_bytes});
  if (!known.import) return std::nullopt;
  const auto textures = known.import->textures(tools_.dma_bufs->textures, (*native.dma_buf)[0]);
  if (!textures) {
    known.import.reset();  // this camera's memory is not like the one that was tried
    return std::nullopt;
  }
  way_ = "dma-buf " + std::string(name_of(native.format));
  return *textures;
}

GlesInput::KnownPacking& GlesInput::know(const PackedLayout& layout) {
  const auto found = std::ranges::find(packings_, layout, &KnownPacking::layout);
  if (found != packings_.end()) return *found;
  KnownPacking known = {layout, std::nullopt};
  const auto view = choose_packed_view(*tools_.dma_bufs, tools_.painter, layout,
                                       tools_.gles_version, tools_.readback);
  if (view) {
    auto import = PackedImport::create(*view, layout, tools_.gles_version);
    if (import) known.import = std::move(*import);
  }
  packings_.push_back(std::move(known));
  return packings_.back();
}

GlesInput::KnownFormat& GlesInput::know(NativeFormat format) {
  const auto found = std::ranges::find(formats_, format, &KnownFormat::format);
  if (found != formats_.end()) return *found;
  KnownFormat known = {format, std::nullopt};
  if (converts_as_the_processor(tools_.painter, format, tools_.gles_version, tools_.readback)) {
    auto input = NativeInput::create(format, picture_, tools_.gles_version);
    if (input) known.input = std::move(*input);
  }
  formats_.push_back(std::move(known));
  return formats_.back();
}

std::optional<std::array<GLuint, 2>> GlesInput::import(const VideoFrame& frame) {
  if (!tools_.dma_bufs || !frame.dma_buf) return std::nullopt;
  const auto layout = layout_of(frame);
  if (!layout) return std::nullopt;
  KnownLayout& known = know(*layout);
  if (!known.sources) return std::nullopt;
  const auto textures = known.sources->textures(
      tools_.dma_bufs->textures,
      {*frame.dma_buf, {layout->luma_stride_bytes, layout->chroma_stride_bytes}});
  if (!textures) {
    known.sources.reset();  // this camera's memory is not like the one that was tried
    return std::nullopt;
  }
  way_ = dma_buf_text(*known.view);
  return *textures;
}

GlesInput::KnownLayout& GlesInput::know(const PictureLayout& layout) {
  const auto found = std::ranges::find(layouts_, layout, &KnownLayout::layout);
  if (found != layouts_.end()) return *found;
  KnownLayout known = {layout, std::nullopt, std::nullopt};
  known.view = choose_source_view(*tools_.dma_bufs, tools_.import_painter(), layout,
                                  tools_.gles_version, tools_.readback);
  if (known.view) {
    auto sources = DmaBufSources::create(*known.view, layout.size, tools_.gles_version);
    if (sources) known.sources = std::move(*sources);
  }
  layouts_.push_back(std::move(known));
  return layouts_.back();
}

}  // namespace gimbal

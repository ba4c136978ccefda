#include "pipeline/warp/gles_output.hpp"

#include <utility>

namespace gimbal {

GlesOutput::GlesOutput(GlesTools& tools, ImageSize picture, std::array<PlaneReadback, 2> readbacks)
    : tools_(&tools), size_(picture), readbacks_(std::move(readbacks)) {}

Result<GlesOutput> GlesOutput::create(GlesTools& tools, ImageSize picture) {
  auto luma = PlaneReadback::create(Plane::luma, picture, tools.gles_version, tools.readback);
  if (!luma) return tl::unexpected(luma.error());
  auto chroma = PlaneReadback::create(Plane::chroma, picture, tools.gles_version, tools.readback);
  if (!chroma) return tl::unexpected(chroma.error());
  GlesOutput made(tools, picture, {std::move(*luma), std::move(*chroma)});
  if (tools.dma_bufs) made.draw_into_dma_bufs();
  return made;
}

void GlesOutput::draw_into_dma_bufs() {
  view_ = choose_target_view(*tools_->dma_bufs, tools_->painter, size_, tools_->gles_version);
  if (!view_) return;
  auto targets = DmaBufTargets::create(*view_, size_, tools_->gles_version);
  if (!targets) return;
  targets_ = std::move(*targets);
  // Plain memory where the heap has no more.
  pool_ = PicturePool([heap = tools_->dma_bufs->heap](ImageSize size) {
    auto picture = heap.allocate(padded_layout(size));
    if (!picture) return Nv12Buffer(size);
    begin_reading(*picture);  // as all in the pool are, until they are drawn into
    return *std::move(picture);
  });
}

std::array<GLuint, 2> GlesOutput::begin() {
  picture_ = pool_.take(size_);
  if (targets_) {
    if (const auto framebuffers = begin_dma_buf()) return *framebuffers;
    give_up_dma_bufs();
  }
  return {readbacks_[0].framebuffer(), readbacks_[1].framebuffer()};
}

std::optional<std::array<GLuint, 2>> GlesOutput::begin_dma_buf() {
  if (!picture_->dma_buf()) return std::nullopt;
  const auto framebuffers =
      targets_->framebuffers(tools_->dma_bufs->textures, dma_buf_picture(*picture_));
  if (!framebuffers) return std::nullopt;
  end_reading(*picture_);
  return *framebuffers;
}

/// For good: an encoder that has taken over one kind of memory need not take another now and then.
void GlesOutput::give_up_dma_bufs() {
  targets_.reset();
  view_.reset();
  pool_ = PicturePool();
  picture_ = pool_.take(size_);
}

Result<VideoFrame> GlesOutput::finish(const FrameStamp& stamp, const ColorInfo& color) {
  if (auto completed = complete(); !completed) return tl::unexpected(completed.error());
  begin_reading(*picture_);
  VideoFrame frame = pool_.publish(*std::move(picture_), stamp, color);
  picture_.reset();
  return frame;
}

Result<void> GlesOutput::complete() {
  if (targets_) {
    DmaBufs& dma_bufs = *tools_->dma_bufs;
    const auto finished = targets_->finish(dma_bufs.textures, dma_buf_picture(*picture_));
    return finished ? dma_bufs.fence.wait() : finished;
  }
  readbacks_[0].read(picture_->luma());
  readbacks_[1].read(picture_->chroma());
  bytes_copied_ += nv12_bytes(size_);
  return {};
}

}  // namespace gimbal

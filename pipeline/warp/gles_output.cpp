#include "pipeline/warp/gles_output.hpp"

#include <utility>

namespace gimbal {

Result<GlesOutput> GlesOutput::create(GlesTools& tools, ImageSize picture) {
  GlesOutput made(tools, picture);
  if (tools.dma_bufs) made.draw_into_dma_bufs();
  if (made.targets_) return made;
  if (auto ready = made.make_readbacks(); !ready) return tl::unexpected(ready.error());
  return made;
}

Result<void> GlesOutput::make_readbacks() {
  auto luma = PlaneReadback::create(Plane::luma, size_, tools_->gles_version, tools_->readback);
  if (!luma) return tl::unexpected(luma.error());
  auto chroma = PlaneReadback::create(Plane::chroma, size_, tools_->gles_version, tools_->readback);
  if (!chroma) return tl::unexpected(chroma.error());
  readbacks_.push_back({std::move(*luma), std::move(*chroma)});
  return {};
}

void GlesOutput::draw_into_dma_bufs() {
  const auto view =
      choose_target_view(*tools_->dma_bufs, tools_->painter, size_, tools_->gles_version);
  if (!view) return;
  auto targets = DmaBufTargets::create(*view, size_, tools_->gles_version);
  if (!targets) return;
  view_ = view;
  targets_ = std::move(*targets);
  // Plain memory where the heap has no more.
  pool_ = PicturePool([heap = tools_->dma_bufs->heap](ImageSize size) {
    auto picture = heap.allocate(padded_layout(size));
    if (!picture) return Nv12Buffer(size);
    begin_reading(*picture);  // as all in the pool are, until they are drawn into
    return *std::move(picture);
  });
}

Result<GlesOutput::Picture> GlesOutput::begin() {
  if (targets_) {
    if (auto picture = begin_dma_buf()) return *std::move(picture);
    give_up_dma_bufs();
  }
  if (readbacks_.empty()) {
    if (auto ready = make_readbacks(); !ready) return tl::unexpected(ready.error());
  }
  Picture picture = {pool_.take(size_), {}, std::move(readbacks_.back()), {}};
  readbacks_.pop_back();
  const auto& [luma, chroma] = *picture.readbacks;
  picture.framebuffers = {luma.framebuffer(), chroma.framebuffer()};
  return picture;
}

std::optional<GlesOutput::Picture> GlesOutput::begin_dma_buf() {
  Nv12Buffer memory = pool_.take(size_);
  if (!memory.dma_buf()) return std::nullopt;
  const auto framebuffers =
      targets_->framebuffers(tools_->dma_bufs->textures, dma_buf_picture(memory));
  if (!framebuffers) return std::nullopt;
  end_reading(memory);
  return Picture{std::move(memory), *framebuffers, {}, {}};
}

/// For good: an encoder that has taken over one kind of memory need not take another now and then.
void GlesOutput::give_up_dma_bufs() {
  targets_.reset();
  view_.reset();
  pool_ = PicturePool();
}

Result<void> GlesOutput::send(Picture& picture) {
  if (picture.readbacks) {
    auto& [luma, chroma] = *picture.readbacks;
    luma.begin(picture.memory.luma().stride_bytes);
    chroma.begin(picture.memory.chroma().stride_bytes);
    glFlush();
    return {};
  }
  DmaBufs& dma_bufs = *tools_->dma_bufs;
  auto packed = targets_->finish(dma_bufs.textures, dma_buf_picture(picture.memory));
  if (packed) picture.fence = dma_bufs.fences.insert();
  return packed;
}

Result<VideoFrame> GlesOutput::finish(Picture picture, const FrameStamp& stamp,
                                      const ColorInfo& color) {
  if (auto completed = complete(picture); !completed) return tl::unexpected(completed.error());
  begin_reading(picture.memory);
  // The pool is another one by now if dma-bufs were given up meanwhile.
  if (picture.memory.dma_buf() && !targets_) return std::move(picture.memory).publish(stamp, color);
  return pool_.publish(std::move(picture.memory), stamp, color);
}

Result<void> GlesOutput::complete(Picture& picture) {
  if (picture.fence) return picture.fence->wait();
  auto& [luma, chroma] = *picture.readbacks;
  if (auto read = luma.finish(picture.memory.luma()); !read) return read;
  if (auto read = chroma.finish(picture.memory.chroma()); !read) return read;
  readbacks_.push_back(*std::move(picture.readbacks));
  bytes_copied_ += nv12_bytes(size_);
  return {};
}

}  // namespace gimbal

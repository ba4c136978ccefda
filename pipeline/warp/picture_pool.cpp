#include "pipeline/warp/picture_pool.hpp"

#include <mutex>
#include <utility>
#include <vector>

#include "pipeline/queue/surplus_gauge.hpp"

namespace gimbal {

struct PicturePool::Shelf {
  SurplusGauge gauge;
  std::mutex mutex;
  std::vector<Nv12Buffer> pictures;
};

PicturePool::PicturePool(Allocate allocate)
    : allocate_(std::move(allocate)), shelf_(std::make_shared<Shelf>()) {}

Nv12Buffer PicturePool::take(ImageSize size) {
  const std::scoped_lock lock(shelf_->mutex);
  // A change of size happens once in a run; what is left of the old size is of no use.
  std::erase_if(shelf_->pictures,
                [&](const Nv12Buffer& picture) { return picture.size() != size; });
  if (shelf_->pictures.empty()) return allocate_(size);
  Nv12Buffer picture = std::move(shelf_->pictures.back());
  shelf_->pictures.pop_back();
  return picture;
}

VideoFrame PicturePool::publish(Nv12Buffer picture, FrameStamp stamp, ColorInfo color) {
  VideoFrame frame;
  frame.stamp = stamp;
  frame.size = picture.size();
  frame.color = std::move(color);
  frame.planes = {{{picture.luma().data, picture.luma().stride_bytes},
                   {picture.chroma().data, picture.chroma().stride_bytes}}};
  frame.dma_buf = picture.dma_buf();
  auto lent = std::make_unique<Nv12Buffer>(std::move(picture));
  shelf_->gauge.lent();
  frame.storage = std::shared_ptr<const void>(lent.release(), [shelf = shelf_](const void* memory) {
    const std::unique_ptr<const Nv12Buffer> returned(static_cast<const Nv12Buffer*>(memory));
    if (shelf->gauge.returned_for_good()) return;
    const std::scoped_lock lock(shelf->mutex);
    shelf->pictures.push_back(*returned);
  });
  return frame;
}

}  // namespace gimbal

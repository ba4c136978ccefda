#include "drivers/replay/chroma_weaver.hpp"

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "pipeline/pixels/nv12_conversion.hpp"
#include "pipeline/queue/surplus_gauge.hpp"

namespace gimbal {
namespace {

using Memory = std::vector<std::uint8_t>;

/// What keeps a woven frame's planes alive.
struct Storage {
  std::shared_ptr<const void> luma;
  std::shared_ptr<const Memory> chroma;
};

}  // namespace

struct ChromaWeaver::Shelf {
  SurplusGauge gauge;
  std::mutex mutex;
  std::vector<Memory> free;

  [[nodiscard]] Memory take(std::size_t bytes) {
    gauge.lent();
    const std::scoped_lock lock(mutex);
    if (free.empty()) return Memory(bytes);
    Memory memory = std::move(free.back());
    free.pop_back();
    memory.resize(bytes);
    return memory;
  }

  void put_back(Memory memory) {
    if (gauge.returned_for_good()) return;
    const std::scoped_lock lock(mutex);
    free.push_back(std::move(memory));
  }
};

ChromaWeaver::ChromaWeaver() : shelf_(std::make_shared<Shelf>()) {}

void ChromaWeaver::weave(ConstPlane u, ConstPlane v, VideoFrame& frame) {
  const ImageSize size = chroma_size(frame.size);
  const std::ptrdiff_t row_bytes = std::ptrdiff_t{2} * size.width;
  auto memory =
      std::make_unique<Memory>(shelf_->take(static_cast<std::size_t>(row_bytes * size.height)));
  const MutablePlane woven{memory->data(), row_bytes};
  interleave_chroma(u, v, size, woven);
  bytes_written_ += row_bytes * size.height;
  frame.planes[1] = {woven.data, woven.stride_bytes};
  std::shared_ptr<const Memory> lent(memory.release(), [shelf = shelf_](Memory* returned) {
    shelf->put_back(std::move(*std::unique_ptr<Memory>(returned)));
  });
  frame.storage =
      std::make_shared<const Storage>(Storage{std::move(frame.storage), std::move(lent)});
}

}  // namespace gimbal

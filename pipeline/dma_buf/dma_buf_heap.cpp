#include "pipeline/dma_buf/dma_buf_heap.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <linux/dma-buf.h>
#include <linux/dma-heap.h>
#include <linux/udmabuf.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <utility>

namespace gimbal {
namespace {

/// Panfrost refuses strides that are not multiples of 64 bytes, others want more.
constexpr std::ptrdiff_t kStrideStep_bytes = 256;

/// Renderers draw in blocks of rows, llvmpipe also those of a picture's last block that it does not
/// have: they must be there.
constexpr std::ptrdiff_t kRowStep = 16;

std::ptrdiff_t rounded_up(std::ptrdiff_t bytes, std::ptrdiff_t step) {
  return (bytes + step - 1) / step * step;
}

class File {
 public:
  explicit File(int fd) : fd_(fd) {}
  File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  File& operator=(File&&) = delete;
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (fd_ >= 0) ::close(fd_);
  }
  [[nodiscard]] int get() const { return fd_; }
  [[nodiscard]] bool is_open() const { return fd_ >= 0; }

 private:
  int fd_;
};

/// Gives the descriptor of a new dma-buf, or one that is not open, with errno set.
using Allocate = File (*)(int heap, std::size_t bytes);

File from_heap(int heap, std::size_t bytes) {
  dma_heap_allocation_data request{};
  request.len = bytes;
  request.fd_flags = O_RDWR | O_CLOEXEC;
  const int status = ::ioctl(heap, DMA_HEAP_IOCTL_ALLOC, &request);
  return File(status < 0 ? -1 : static_cast<int>(request.fd));
}

File from_udmabuf(int device, std::size_t bytes) {
  const File memory(::memfd_create("gimbald picture", MFD_ALLOW_SEALING | MFD_CLOEXEC));
  if (!memory.is_open()) return File(-1);
  if (::ftruncate(memory.get(), static_cast<off_t>(bytes)) != 0) return File(-1);
  if (::fcntl(memory.get(), F_ADD_SEALS, F_SEAL_SHRINK) != 0) return File(-1);
  udmabuf_create request{};
  request.memfd = static_cast<std::uint32_t>(memory.get());
  request.flags = UDMABUF_FLAGS_CLOEXEC;
  request.size = bytes;
  return File(::ioctl(device, UDMABUF_CREATE, &request));
}

struct HeapPlace {
  const char* path;
  Allocate allocate;
};

/// Contiguous memory has had several names: Raspberry Pi's and mainline's.
constexpr HeapPlace kPlaces[] = {{"/dev/dma_heap/linux,cma", from_heap},
                                 {"/dev/dma_heap/default_cma_region", from_heap},
                                 {"/dev/dma_heap/reserved", from_heap},
                                 {"/dev/dma_heap/system", from_heap},
                                 {"/dev/udmabuf", from_udmabuf}};

/// A dma-buf that the processor sees, too.
class MappedDmaBuf {
 public:
  MappedDmaBuf(File file, std::size_t bytes)
      : file_(std::move(file)),
        bytes_(bytes),
        data_(::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file_.get(), 0)) {}
  MappedDmaBuf(const MappedDmaBuf&) = delete;
  MappedDmaBuf& operator=(const MappedDmaBuf&) = delete;
  ~MappedDmaBuf() {
    if (is_mapped()) ::munmap(data_, bytes_);
  }

  [[nodiscard]] int fd() const { return file_.get(); }
  [[nodiscard]] bool is_mapped() const { return data_ != MAP_FAILED; }
  [[nodiscard]] std::uint8_t* data() const { return static_cast<std::uint8_t*>(data_); }

 private:
  File file_;
  std::size_t bytes_;
  void* data_;
};

std::size_t bytes_of(const PictureLayout& layout) {
  const auto page = static_cast<std::ptrdiff_t>(::sysconf(_SC_PAGESIZE));
  const std::ptrdiff_t rows = rounded_up(chroma_size(layout.size).height, kRowStep);
  return static_cast<std::size_t>(
      rounded_up(layout.chroma_offset_bytes + layout.chroma_stride_bytes * rows, page));
}

void sync(const Nv12Buffer& picture, std::uint64_t flags) {
  if (!picture.dma_buf()) return;
  dma_buf_sync access{flags};
  while (::ioctl((*picture.dma_buf())[0].fd, DMA_BUF_IOCTL_SYNC, &access) != 0 && errno == EINTR) {
  }
}

}  // namespace

struct DmaBufHeap::Heap {
  HeapPlace place;
  File file;
};

PictureLayout padded_layout(ImageSize size) {
  const std::ptrdiff_t stride =
      rounded_up(std::ptrdiff_t{2} * chroma_size(size).width, kStrideStep_bytes);
  return {size, stride, stride, stride * size.height};
}

DmaBufHeap::DmaBufHeap(std::vector<std::shared_ptr<const Heap>> heaps) : heaps_(std::move(heaps)) {}

Result<DmaBufHeap> DmaBufHeap::open() {
  std::vector<std::shared_ptr<const Heap>> heaps;
  std::vector<std::string> refusals;
  for (const HeapPlace& place : kPlaces) {
    File file(::open(place.path, O_RDWR | O_CLOEXEC));
    if (file.is_open()) {
      heaps.push_back(std::make_shared<const Heap>(Heap{place, std::move(file)}));
    } else if (errno != ENOENT) {
      refusals.push_back(fmt::format("{}: {}", place.path, std::strerror(errno)));
    }
  }
  if (!heaps.empty()) return DmaBufHeap(std::move(heaps));
  if (refusals.empty()) return failed("there is neither /dev/dma_heap nor /dev/udmabuf");
  return failed(fmt::format("{}", fmt::join(refusals, ", ")));
}

Result<Nv12Buffer> DmaBufHeap::allocate(const PictureLayout& layout) const {
  const std::size_t bytes = bytes_of(layout);
  std::string refusal;
  for (const auto& heap : heaps_) {
    File file = heap->place.allocate(heap->file.get(), bytes);
    if (file.is_open()) {
      const auto memory = std::make_shared<MappedDmaBuf>(std::move(file), bytes);
      if (memory->is_mapped()) {
        return Nv12Buffer(
            layout.size,
            {{{memory->data(), layout.luma_stride_bytes},
              {memory->data() + layout.chroma_offset_bytes, layout.chroma_stride_bytes}}},
            memory, {{{memory->fd(), 0}, {memory->fd(), layout.chroma_offset_bytes}}});
      }
    }
    refusal = fmt::format("{}: {}", heap->place.path, std::strerror(errno));
  }
  return failed(fmt::format("no memory for pictures of {}x{} ({})", layout.size.width,
                            layout.size.height, refusal));
}

void begin_reading(const Nv12Buffer& picture) {
  sync(picture, DMA_BUF_SYNC_START | DMA_BUF_SYNC_READ);
}

void end_reading(const Nv12Buffer& picture) {
  sync(picture, DMA_BUF_SYNC_END | DMA_BUF_SYNC_READ);
}

void begin_writing(const Nv12Buffer& picture) {
  sync(picture, DMA_BUF_SYNC_START | DMA_BUF_SYNC_WRITE);
}

void end_writing(const Nv12Buffer& picture) {
  sync(picture, DMA_BUF_SYNC_END | DMA_BUF_SYNC_WRITE);
}

}  // namespace gimbal

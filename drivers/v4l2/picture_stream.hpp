#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "drivers/v4l2/picture_format.hpp"
#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A buffer that the device has filled.
struct FilledBuffer {
  std::uint32_t index = 0;
  std::uint32_t flags = 0;
  std::uint32_t sequence = 0;
  SensorDuration stamp{};  ///< by the driver's clock, since that clock's epoch
  /// Of each memory: where the picture begins, how many bytes it has, and what can be imported.
  struct Memory {
    const std::uint8_t* data = nullptr;
    std::size_t bytes = 0;
    int dma_buf = -1;  ///< belongs to the stream; -1 if there is none for devices to read
    std::ptrdiff_t offset_bytes = 0;
  };
  std::vector<Memory> memories;
};

/// A device that streams into mapped buffers. Frames may hold buffers longer than the camera that
/// made them lives; they hold the stream with them. `stop` and `give_back` may come from any
/// thread.
class PictureStream : public std::enable_shared_from_this<PictureStream> {
 public:
  /// Takes the device over. `buffers`: how many to ask for; the driver may give others.
  [[nodiscard]] static Result<std::shared_ptr<PictureStream>> start(
      std::unique_ptr<V4l2Device> device, const PictureFormat& format, int buffers,
      const std::string& users);

  PictureStream(const PictureStream&) = delete;
  PictureStream& operator=(const PictureStream&) = delete;
  ~PictureStream();

  /// The next filled buffer; nothing once stopped. Fails when the device is gone, or silent for
  /// longer than `silence_limit`. What it returns is to be lent or given back.
  [[nodiscard]] Result<std::optional<FilledBuffer>> next(SensorDuration silence_limit);

  /// Keeps a buffer, and the stream, until the last copy of what is returned goes; nothing where
  /// the device would be left with too few to go on.
  [[nodiscard]] std::shared_ptr<const void> lend(std::uint32_t index);

  void give_back(std::uint32_t index);

  void stop();
  [[nodiscard]] bool has_stopped() const;

  /// As the driver says before there is a picture: V4L2_BUF_FLAG_TIMESTAMP_* and _TSTAMP_SRC_*.
  [[nodiscard]] std::uint32_t stamp_flags() const { return stamp_flags_; }

  [[nodiscard]] std::optional<SensorDuration> read_clock(KernelClock clock) const {
    return device_->read_clock(clock);
  }

 private:
  struct Memory {
    std::uint8_t* data = nullptr;
    std::size_t bytes = 0;
    int dma_buf = -1;
  };
  /// A v4l2_buffer with the planes that it points to.
  struct Descriptor;

  PictureStream(std::unique_ptr<V4l2Device> device, const PictureFormat& format);

  [[nodiscard]] Result<void> allocate(int buffers, const std::string& users);
  [[nodiscard]] Result<void> map_buffer(std::uint32_t index);
  [[nodiscard]] int export_memory(std::uint32_t index, std::size_t memory);
  [[nodiscard]] Result<void> begin();
  [[nodiscard]] Result<std::optional<FilledBuffer>> dequeue();
  [[nodiscard]] int queue(std::uint32_t index);
  void release();

  std::unique_ptr<V4l2Device> device_;
  std::uint32_t type_;
  std::size_t memory_count_;
  std::vector<std::vector<Memory>> buffers_;
  std::uint32_t stamp_flags_ = 0;
  bool is_exported_ = false;  ///< buffers are, as dma-bufs

  mutable std::mutex mutex_;  ///< for what follows, and for the device but for waiting
  bool is_streaming_ = false;
  bool is_stopped_ = false;
  std::size_t queued_ = 0;
  std::size_t kept_for_device_ = 2;
};

}  // namespace gimbal

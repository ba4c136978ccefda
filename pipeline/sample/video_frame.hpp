#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

struct ImageSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// Size of the interleaved half-resolution chroma plane of NV12; odd sizes round up.
constexpr ImageSize chroma_size(ImageSize luma) {
  return {(luma.width + 1) / 2, (luma.height + 1) / 2};
}

/// When a frame was taken, by the camera's clock and reference instant.
struct FrameStamp {
  std::int64_t index = 0;
  SensorTime time;
  std::optional<SensorDuration> exposure;
  /// What the camera's clock was off by when this frame was taken, beyond the time offset of its
  /// calibration: added like that.
  SensorDuration clock_correction = {};
};

/// Where a chroma sample lies between the luma samples of its 2x2 block.
enum class ChromaSiting : std::uint8_t {
  left,    ///< on the left luma column, between the rows (MPEG-2, H.264)
  center,  ///< in the middle of the block (JPEG)
};

/// What is carried through untouched.
struct ColorInfo {
  /// GStreamer's caps notation, such as "bt709"; empty if unknown.
  std::string colorimetry;
  ChromaSiting chroma_siting = ChromaSiting::left;
};

/// One plane of a picture; rows are `stride_bytes` apart.
struct ConstPlane {
  const std::uint8_t* data = nullptr;
  std::ptrdiff_t stride_bytes = 0;
};

struct MutablePlane {
  std::uint8_t* data = nullptr;
  std::ptrdiff_t stride_bytes = 0;
};

/// Where a plane lies in a dma-buf, for a GPU that is to read it without a copy. The descriptor
/// belongs to the frame's storage: who needs it longer duplicates it.
struct DmaBufPlane {
  int fd = -1;
  std::ptrdiff_t offset_bytes = 0;
};

/// What cameras and decoders deliver that is not NV12.
enum class NativeFormat : std::uint8_t {
  i420,  ///< planes Y, U and V; U and V have chroma_size
  yuyv,  ///< a row is (width + 1) / 2 groups of four bytes that hold two pixels: Y, U, Y, V
  uyvy,  ///< the same as U, Y, V, Y
  rgb,   ///< three bytes a pixel, full range
  bgr,
};

/// For people: "YUYV".
[[nodiscard]] std::string_view name_of(NativeFormat format);

/// A picture as the camera laid it out. I420 has three planes, all else has one.
struct NativePicture {
  NativeFormat format = NativeFormat::i420;
  std::array<ConstPlane, 3> planes;
  /// The same memory, where the driver exports it.
  std::optional<std::array<DmaBufPlane, 3>> dma_buf = {};
};

/// A picture in NV12: plane 0 is luma, size.height rows of size.width bytes; plane 1 is interleaved
/// U and V, chroma_size(size) pairs. Or, from a source that was asked for it, a native one in its
/// place: warpers take both, whoever else looks at pixels takes as_nv12 of it. Read only and cheap
/// to copy: copies share the storage.
struct VideoFrame {
  FrameStamp stamp;
  ImageSize size;
  ColorInfo color;
  std::array<ConstPlane, 2> planes;  ///< null where the picture is native
  std::optional<NativePicture> native = {};
  std::shared_ptr<const void> storage;  ///< keeps the planes' memory alive
  /// The same memory as that of `planes`, with their strides, where the driver exports it.
  std::optional<std::array<DmaBufPlane, 2>> dma_buf = {};
};

/// Picture memory that its maker still writes; `publish` makes a frame of it.
class Nv12Buffer {
 public:
  /// Contents are not initialised. Strides are multiples of 64 bytes.
  explicit Nv12Buffer(ImageSize size);

  /// In memory that `storage` keeps, and that is also where `dma_buf` says.
  Nv12Buffer(ImageSize size, const std::array<MutablePlane, 2>& planes,
             std::shared_ptr<void> storage, const std::array<DmaBufPlane, 2>& dma_buf);

  [[nodiscard]] ImageSize size() const { return size_; }
  [[nodiscard]] MutablePlane luma() const { return planes_[0]; }
  [[nodiscard]] MutablePlane chroma() const { return planes_[1]; }
  [[nodiscard]] const std::optional<std::array<DmaBufPlane, 2>>& dma_buf() const {
    return dma_buf_;
  }

  /// Hands the picture over; the buffer must not be written afterwards.
  [[nodiscard]] VideoFrame publish(FrameStamp stamp, ColorInfo color) &&;

 private:
  ImageSize size_;
  std::array<MutablePlane, 2> planes_;
  std::shared_ptr<void> storage_;
  std::optional<std::array<DmaBufPlane, 2>> dma_buf_;
};

}  // namespace gimbal

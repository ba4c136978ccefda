#pragma once

#include <linux/videodev2.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Pixel formats that this driver reads, in the order of the work that they make.
enum class PixelLayout : std::uint8_t {
  nv12,
  nv12_two_memories,
  i420,
  yv12,
  uyvy,
  yuyv,
  mjpeg,
  grey,
};

struct KnownPixelFormat {
  std::uint32_t fourcc;
  PixelLayout layout;
};

/// In the order of the work that they make.
[[nodiscard]] const std::vector<KnownPixelFormat>& known_pixel_formats();

[[nodiscard]] std::string name_of_fourcc(std::uint32_t fourcc);

/// Frames in a second, of some size; no rates means that the device does not list them.
struct OfferedSize {
  ImageSize size;
  std::vector<double> rates_hz;
};

/// The sizes of a device that lists ranges are those that it is asked about.
struct OfferedFormat {
  std::uint32_t fourcc = 0;
  std::vector<OfferedSize> sizes;
  std::optional<std::array<ImageSize, 2>> range;  ///< smallest and largest, of a device with ranges
};

/// What the device says that it is.
struct NodeIdentity {
  std::string name;      ///< of the card
  std::string bus;       ///< such as "usb-0000:00:14.0-1"
  std::uint32_t type;    ///< V4L2_BUF_TYPE_VIDEO_CAPTURE or its multi-planar form; 0: no pictures
  std::string obstacle;  ///< why no pictures come out of it; empty if they do
};

[[nodiscard]] Result<NodeIdentity> identify(V4l2Device& device);

/// All formats, also those that this driver cannot read.
[[nodiscard]] std::vector<OfferedFormat> offered_formats(V4l2Device& device, std::uint32_t type,
                                                         std::optional<ImageSize> size);

/// A line about a format: "YUYV: 640x480 (30, 15 fps), 1280x720 (10 fps)".
[[nodiscard]] std::string describe(const OfferedFormat& format);

struct FormatWish {
  std::optional<ImageSize> size;
  std::optional<double> fps;
  std::string pixel_format = "auto";
};

/// The format to set. Fails with what there is.
[[nodiscard]] Result<KnownPixelFormat> choose_format(const std::vector<OfferedFormat>& offered,
                                                     const FormatWish& wish);

/// One memory of a picture: NV12 has one, NM12 two.
struct PictureMemory {
  std::ptrdiff_t stride_bytes = 0;
  std::size_t bytes = 0;
};

/// What the device has been set to.
struct PictureFormat {
  std::uint32_t type = 0;  ///< of the buffers
  ImageSize size;
  PixelLayout layout = PixelLayout::nv12;
  std::uint32_t fourcc = 0;
  std::vector<PictureMemory> memories;
  ColorInfo color;
  double fps = 0;  ///< 0: the device does not say
};

/// What the device is set to now; nothing where it does not tell or has not been set.
[[nodiscard]] std::optional<ImageSize> current_size(V4l2Device& device, std::uint32_t type);

/// Sets pixel format, size and rate, and reads back what came of it. Fails where that is something
/// else, or would not fit its buffers. `users`: who else has the device open, for the message.
[[nodiscard]] Result<PictureFormat> set_format(V4l2Device& device, std::uint32_t type,
                                               KnownPixelFormat format, const FormatWish& wish,
                                               const std::string& users);

/// Where a plane lies in a picture's memories.
struct PlanePlace {
  std::size_t memory = 0;
  std::ptrdiff_t offset_bytes = 0;
  std::ptrdiff_t stride_bytes = 0;
};

/// Of an uncompressed picture: luma, then chroma in the order of NV12 or of Y, U, V; a packed
/// layout has one plane. Chroma follows luma without a gap, with half of its stride where U and V
/// are apart (userspace-api/media/v4l/pixfmt-yuv-planar.rst).
[[nodiscard]] std::vector<PlanePlace> places_of(const PictureFormat& format);

/// Bytes of each memory that an uncompressed picture takes; none for MJPEG.
[[nodiscard]] std::vector<std::size_t> least_bytes(const PictureFormat& format);

}  // namespace gimbal

#pragma once

#include <libcamera/libcamera.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// The pixel formats that this driver reads, in the order of the work that they make. libcamera has
/// the names of DRM, by which RGB888 lies in memory as B, G, R.
enum class LibcameraLayout : std::uint8_t { nv12, yuv420, bgr_bytes, rgb_bytes };

struct KnownLibcameraFormat {
  libcamera::PixelFormat format;
  LibcameraLayout layout = LibcameraLayout::nv12;
  const char* name = "";  ///< its fourcc
};

/// In the order of the work that they make.
[[nodiscard]] const std::vector<KnownLibcameraFormat>& known_libcamera_formats();

/// What such pictures are where they are not NV12.
[[nodiscard]] std::optional<NativeFormat> native_format(LibcameraLayout layout);

/// How the pictures of a stream lie.
struct LibcameraPictures {
  ImageSize size;
  LibcameraLayout layout = LibcameraLayout::nv12;
  std::ptrdiff_t stride_bytes = 0;  ///< of the first plane
  ColorInfo color;
};

/// A colour space in GStreamer's caps notation; unknown where there is none, or a raw one.
[[nodiscard]] std::string colorimetry_of(const std::optional<libcamera::ColorSpace>& space);

/// What frames will say of their colours: those of RGB are converted, and then as JPEG has them.
[[nodiscard]] ColorInfo color_of(LibcameraLayout layout,
                                 const std::optional<libcamera::ColorSpace>& space);

/// The distance of rows in each plane, and the bytes from its begin to the last row's end.
struct PlaneExtent {
  std::ptrdiff_t stride_bytes = 0;
  std::size_t bytes = 0;
};
[[nodiscard]] std::vector<PlaneExtent> extents_of(const LibcameraPictures& pictures);

/// A picture that is not NV12, converted. `planes`: as many as there are extents.
[[nodiscard]] Nv12Buffer converted(const LibcameraPictures& pictures,
                                   const std::vector<ConstPlane>& planes);

}  // namespace gimbal

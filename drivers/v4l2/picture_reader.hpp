#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/v4l2/mjpeg_decoder.hpp"
#include "drivers/v4l2/picture_format.hpp"
#include "drivers/v4l2/picture_stream.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Makes frames of a stream's buffers. NV12 is passed on where it lies, and where native pictures
/// are wanted so is what has a NativeFormat, as long as that leaves the device enough buffers; all
/// else is converted.
class PictureReader {
 public:
  explicit PictureReader(PictureFormat format);

  /// Takes the buffer over: it goes back to the device now, or with the frame. Nothing if the
  /// picture is damaged or cut off.
  [[nodiscard]] std::optional<VideoFrame> read(const FilledBuffer& buffer, PictureStream& stream,
                                               const FrameStamp& stamp, PictureForm form);

 private:
  [[nodiscard]] bool is_whole(const FilledBuffer& buffer) const;
  [[nodiscard]] ConstPlane plane(const FilledBuffer& buffer, std::size_t index) const;
  template <std::size_t kCount>
  [[nodiscard]] std::optional<std::array<DmaBufPlane, kCount>> exported(
      const FilledBuffer& buffer) const;
  [[nodiscard]] bool can_stay(PictureForm form) const;
  [[nodiscard]] std::optional<VideoFrame> in_place(const FilledBuffer& buffer,
                                                   PictureStream& stream,
                                                   const FrameStamp& stamp) const;
  [[nodiscard]] std::optional<Nv12Buffer> converted(const FilledBuffer& buffer);

  PictureFormat format_;
  std::vector<PlanePlace> places_;
  std::vector<std::size_t> least_bytes_;
  MjpegDecoder decoder_;
};

}  // namespace gimbal

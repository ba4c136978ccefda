#pragma once

#include <gst/video/video.h>

#include <memory>
#include <optional>
#include <vector>

#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/queue/surplus_gauge.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Caps of NV12 pictures. A rate of 0 means unknown; a colorimetry that GStreamer does not know is
/// left out.
[[nodiscard]] GstCapsPtr nv12_caps(ImageSize size, double fps, const ColorInfo& color);

/// What caps of a picture say of colour. A chroma site that is not said, or that ColorInfo cannot
/// name, is `left`, as most codecs have it.
[[nodiscard]] ColorInfo color_of(const GstCaps* caps);

/// A read-only buffer over the frame's own memory, in one piece where the planes are, with its
/// strides as GstVideoMeta; it keeps the frame's storage until GStreamer lets go of it. What lies
/// in a dma-buf goes as one, which encoders and displays can import. Presentation time and duration
/// are not set.
[[nodiscard]] GstBufferPtr wrap_frame(const VideoFrame& frame);

/// A picture as it lies in a sample's own memory.
struct MappedPicture {
  ImageSize size;
  ColorInfo color;
  std::vector<ConstPlane> planes;       ///< of NV12 two, of I420 three
  std::shared_ptr<const void> storage;  ///< keeps the memory
};

/// `gauge`: of the pool that the memory goes back to. Nothing if the sample does not hold what its
/// caps say.
[[nodiscard]] std::optional<MappedPicture> map_picture(GstSample* sample,
                                                       std::shared_ptr<SurplusGauge> gauge);

}  // namespace gimbal

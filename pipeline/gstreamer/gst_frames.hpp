#pragma once

#include <gst/video/video.h>

#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Caps of NV12 pictures. A rate of 0 means unknown; a colorimetry that GStreamer does not know is
/// left out.
[[nodiscard]] GstCapsPtr nv12_caps(ImageSize size, double fps, const ColorInfo& color);

/// What caps say of colour. Chroma sites that ColorInfo cannot name become the nearest one.
[[nodiscard]] ColorInfo color_of(const GstVideoInfo& info);

/// A read-only buffer over the frame's own memory, with its strides as GstVideoMeta; it keeps the
/// frame's storage until GStreamer lets go of it. Presentation time and duration are not set.
[[nodiscard]] GstBufferPtr wrap_frame(const VideoFrame& frame);

/// The picture of a buffer with the stamp given, over the buffer's own memory; the frame keeps the
/// buffer. Nothing if the buffer does not hold what `info` (NV12) says.
[[nodiscard]] std::optional<VideoFrame> map_frame(GstBuffer* buffer, const GstVideoInfo& info,
                                                  const FrameStamp& stamp);

}  // namespace gimbal

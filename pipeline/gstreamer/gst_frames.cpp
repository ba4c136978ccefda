#include "pipeline/gstreamer/gst_frames.hpp"

#include <gst/allocators/gstdmabuf.h>

#include <string_view>
#include <utility>

namespace gimbal {
namespace {

struct PlaneShape {
  int row_bytes;
  int rows;
};

std::array<PlaneShape, 2> nv12_planes(ImageSize size) {
  const ImageSize chroma = chroma_size(size);
  return {{{size.width, size.height}, {2 * chroma.width, chroma.height}}};
}

/// From the first byte of the first row to the last byte of the last one.
std::size_t bytes_spanned(const PlaneShape& shape, std::ptrdiff_t stride_bytes) {
  return static_cast<std::size_t>(stride_bytes * (shape.rows - 1) + shape.row_bytes);
}

void release_storage(gpointer storage) {
  delete static_cast<std::shared_ptr<const void>*>(storage);
}

GstMemory* wrap_memory(const VideoFrame& frame, const std::uint8_t* from, std::size_t bytes) {
  // The flag keeps GStreamer from writing through the pointer that its interface wants mutable.
  auto* data = const_cast<std::uint8_t*>(from);
  auto* storage = new std::shared_ptr<const void>(frame.storage);
  return gst_memory_new_wrapped(GST_MEMORY_FLAG_READONLY, data, bytes, 0, bytes, storage,
                                release_storage);
}

/// The frame's planes as one dma-buf, from its beginning; null where they lie in several.
GstMemory* wrap_dma_buf(const VideoFrame& frame, std::size_t chroma_bytes) {
  if (!frame.dma_buf || (*frame.dma_buf)[0].fd != (*frame.dma_buf)[1].fd) return nullptr;
  static const std::unique_ptr<GstAllocator, GstObjectUnref> allocator(gst_dmabuf_allocator_new());
  const DmaBufPlane& chroma = (*frame.dma_buf)[1];
  const std::size_t bytes = static_cast<std::size_t>(chroma.offset_bytes) + chroma_bytes;
  // The descriptor is the storage's, which stays as long as the memory does.
  GstMemory* memory = gst_dmabuf_allocator_alloc_with_flags(allocator.get(), chroma.fd, bytes,
                                                            GST_FD_MEMORY_FLAG_DONT_CLOSE);
  GST_MINI_OBJECT_FLAG_SET(memory, GST_MEMORY_FLAG_READONLY);
  gst_mini_object_set_qdata(GST_MINI_OBJECT(memory), g_quark_from_static_string("gimbald-storage"),
                            new std::shared_ptr<const void>(frame.storage), release_storage);
  return memory;
}

/// Keeps a buffer mapped for as long as a frame points into it.
class MappedBuffer {
 public:
  MappedBuffer(GstBuffer* buffer, const GstVideoInfo& info, std::shared_ptr<SurplusGauge> gauge)
      : is_mapped_(gst_video_frame_map(&mapped_, &info, buffer, GST_MAP_READ) != FALSE),
        gauge_(std::move(gauge)) {
    gauge_->lent();
  }
  MappedBuffer(const MappedBuffer&) = delete;
  MappedBuffer& operator=(const MappedBuffer&) = delete;
  ~MappedBuffer() {
    // A pool takes back no buffer whose memory seems to have been changed.
    if (gauge_->returned_for_good() && is_mapped_) {
      GST_BUFFER_FLAG_SET(mapped_.buffer, GST_BUFFER_FLAG_TAG_MEMORY);
    }
    if (is_mapped_) {
      gst_video_frame_unmap(&mapped_);
    }
  }

  [[nodiscard]] bool is_mapped() const { return is_mapped_; }
  [[nodiscard]] ConstPlane plane(guint index) const {
    return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&mapped_, index)),
            GST_VIDEO_FRAME_PLANE_STRIDE(&mapped_, index)};
  }

 private:
  GstVideoFrame mapped_{};
  bool is_mapped_;
  std::shared_ptr<SurplusGauge> gauge_;
};

}  // namespace

GstCapsPtr nv12_caps(ImageSize size, double fps, const ColorInfo& color) {
  gint numerator = 0;
  gint denominator = 1;
  if (fps > 0) {
    gst_util_double_to_fraction(fps, &numerator, &denominator);
  }
  GstCapsPtr caps(gst_caps_new_simple(
      "video/x-raw", "format", G_TYPE_STRING, "NV12", "width", G_TYPE_INT, size.width, "height",
      G_TYPE_INT, size.height, "framerate", GST_TYPE_FRACTION, numerator, denominator,
      "pixel-aspect-ratio", GST_TYPE_FRACTION, 1, 1, "chroma-site", G_TYPE_STRING,
      color.chroma_siting == ChromaSiting::left ? "mpeg2" : "jpeg", nullptr));
  GstVideoColorimetry colorimetry;
  if (gst_video_colorimetry_from_string(&colorimetry, color.colorimetry.c_str())) {
    gst_caps_set_simple(caps.get(), "colorimetry", G_TYPE_STRING, color.colorimetry.c_str(),
                        nullptr);
  }
  return caps;
}

ColorInfo color_of(const GstCaps* caps) {
  // Not by GstVideoInfo, which invents what caps leave open.
  const GstStructure* fields = gst_caps_get_structure(caps, 0);
  const gchar* colorimetry = gst_structure_get_string(fields, "colorimetry");
  const gchar* site = gst_structure_get_string(fields, "chroma-site");
  const bool is_centered = site != nullptr && std::string_view(site) == "jpeg";
  return {colorimetry == nullptr ? "" : colorimetry,
          is_centered ? ChromaSiting::center : ChromaSiting::left};
}

namespace {

/// Where luma and chroma begin in a buffer.
using PlaneOffsets = std::array<std::size_t, 2>;

PlaneOffsets append_memory(const VideoFrame& frame, GstBuffer* buffer) {
  const auto shapes = nv12_planes(frame.size);
  const auto [luma, chroma] = frame.planes;
  const std::size_t luma_bytes = bytes_spanned(shapes[0], luma.stride_bytes);
  const std::size_t chroma_bytes = bytes_spanned(shapes[1], chroma.stride_bytes);
  if (GstMemory* const memory = wrap_dma_buf(frame, chroma_bytes)) {
    gst_buffer_append_memory(buffer, memory);
    const auto& [luma_place, chroma_place] = *frame.dma_buf;
    return {static_cast<std::size_t>(luma_place.offset_bytes),
            static_cast<std::size_t>(chroma_place.offset_bytes)};
  }
  const std::ptrdiff_t luma_rows_bytes = luma.stride_bytes * shapes[0].rows;
  if (chroma.data == luma.data + luma_rows_bytes) {
    const auto chroma_offset = static_cast<std::size_t>(luma_rows_bytes);
    gst_buffer_append_memory(buffer, wrap_memory(frame, luma.data, chroma_offset + chroma_bytes));
    return {0, chroma_offset};
  }
  gst_buffer_append_memory(buffer, wrap_memory(frame, luma.data, luma_bytes));
  gst_buffer_append_memory(buffer, wrap_memory(frame, chroma.data, chroma_bytes));
  return {0, luma_bytes};
}

}  // namespace

GstBufferPtr wrap_frame(const VideoFrame& frame) {
  const auto [luma, chroma] = frame.planes;
  GstBufferPtr buffer(gst_buffer_new());
  const PlaneOffsets begins = append_memory(frame, buffer.get());
  gsize offsets[GST_VIDEO_MAX_PLANES] = {begins[0], begins[1]};
  gint strides[GST_VIDEO_MAX_PLANES] = {static_cast<gint>(luma.stride_bytes),
                                        static_cast<gint>(chroma.stride_bytes)};
  gst_buffer_add_video_meta_full(buffer.get(), GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_FORMAT_NV12,
                                 static_cast<guint>(frame.size.width),
                                 static_cast<guint>(frame.size.height), 2, offsets, strides);
  return buffer;
}

std::optional<MappedPicture> map_picture(GstSample* sample, std::shared_ptr<SurplusGauge> gauge) {
  const GstCaps* caps = gst_sample_get_caps(sample);
  GstVideoInfo info;
  if (!gst_video_info_from_caps(&info, caps)) {
    return std::nullopt;
  }
  auto mapped =
      std::make_shared<const MappedBuffer>(gst_sample_get_buffer(sample), info, std::move(gauge));
  if (!mapped->is_mapped()) {
    return std::nullopt;
  }
  MappedPicture picture;
  picture.size = {GST_VIDEO_INFO_WIDTH(&info), GST_VIDEO_INFO_HEIGHT(&info)};
  picture.color = color_of(caps);
  for (guint i = 0; i < GST_VIDEO_INFO_N_PLANES(&info); ++i) {
    picture.planes.push_back(mapped->plane(i));
  }
  picture.storage = std::move(mapped);
  return picture;
}

}  // namespace gimbal

#include "pipeline/gstreamer/conversion_count.hpp"

#include <gst/base/gstbasetransform.h>

#include <string_view>

#include "pipeline/gstreamer/gst_runtime.hpp"

namespace gimbal {
namespace {

bool converts_pictures(GstElement* element) {
  GstElementFactory* factory = gst_element_get_factory(element);
  if (factory == nullptr || !GST_IS_BASE_TRANSFORM(element)) return false;
  const std::string_view kinds =
      gst_element_factory_get_metadata(factory, GST_ELEMENT_METADATA_KLASS);
  return kinds.find("Converter") != std::string_view::npos &&
         kinds.find("Video") != std::string_view::npos;
}

}  // namespace

void ConversionCount::watch(GstElement* pipeline) {
  GstIterator* elements = gst_bin_iterate_recurse(GST_BIN(pipeline));
  gst_iterator_foreach(elements, watch_element, this);
  gst_iterator_free(elements);
}

void ConversionCount::watch_element(const GValue* item, gpointer count) {
  auto* element = static_cast<GstElement*>(g_value_get_object(item));
  if (!converts_pictures(element)) return;
  const GstPadPtr pad(gst_element_get_static_pad(element, "src"));
  gst_pad_add_probe(pad.get(), GST_PAD_PROBE_TYPE_BUFFER, on_picture, count, nullptr);
}

GstPadProbeReturn ConversionCount::on_picture(GstPad* pad, GstPadProbeInfo* probe, gpointer count) {
  const GstElementPtr element(gst_pad_get_parent_element(pad));
  if (element && !gst_base_transform_is_passthrough(GST_BASE_TRANSFORM(element.get()))) {
    const gsize bytes = gst_buffer_get_size(GST_PAD_PROBE_INFO_BUFFER(probe));
    static_cast<ConversionCount*>(count)->bytes_ += static_cast<std::int64_t>(bytes);
  }
  return GST_PAD_PROBE_OK;
}

}  // namespace gimbal

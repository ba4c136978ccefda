#pragma once

#include <gst/gst.h>

#include <memory>
#include <string>

#include "pipeline/sample/result.hpp"

namespace gimbal {

struct GstObjectUnref {
  void operator()(gpointer object) const { gst_object_unref(object); }
};

struct GstMiniObjectUnref {
  template <typename T>
  void operator()(T* object) const {
    gst_mini_object_unref(GST_MINI_OBJECT_CAST(object));
  }
};

using GstElementPtr = std::unique_ptr<GstElement, GstObjectUnref>;
using GstPadPtr = std::unique_ptr<GstPad, GstObjectUnref>;
using GstClockPtr = std::unique_ptr<GstClock, GstObjectUnref>;
using GstBusPtr = std::unique_ptr<GstBus, GstObjectUnref>;
using GstCapsPtr = std::unique_ptr<GstCaps, GstMiniObjectUnref>;
using GstBufferPtr = std::unique_ptr<GstBuffer, GstMiniObjectUnref>;
using GstSamplePtr = std::unique_ptr<GstSample, GstMiniObjectUnref>;
using GstMessagePtr = std::unique_ptr<GstMessage, GstMiniObjectUnref>;

/// Stops the streaming threads before it lets go, as GStreamer demands.
struct GstPipelineStop {
  void operator()(GstElement* pipeline) const {
    gst_element_set_state(pipeline, GST_STATE_NULL);
    gst_object_unref(pipeline);
  }
};
using GstPipelinePtr = std::unique_ptr<GstElement, GstPipelineStop>;

/// Starts GStreamer once for the process; cheap when it runs already. From then on what GLib and
/// GStreamer print goes to standard error: standard output may carry pictures.
[[nodiscard]] Result<void> init_gstreamer();

/// Builds a pipeline from its text in GStreamer's notation. An element that is not installed is
/// bad_input, with the package that brings it.
[[nodiscard]] Result<GstPipelinePtr> parse_pipeline(const std::string& text);

/// An element of the pipeline by its name in the text; it must be there.
[[nodiscard]] GstElementPtr element_named(const GstPipelinePtr& pipeline, const char* name);

/// Whether a thread of a started pipeline still moves data. If not, and no message says so, an
/// error got lost: decodebin and parsebin lose those that a demuxer posts while they are adding it.
[[nodiscard]] bool is_streaming(const GstPipelinePtr& pipeline);

[[nodiscard]] bool is_element_installed(const char* element);

}  // namespace gimbal

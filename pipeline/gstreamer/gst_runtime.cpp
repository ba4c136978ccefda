#include "pipeline/gstreamer/gst_runtime.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "pipeline/gstreamer/gst_messages.hpp"

namespace gimbal {
namespace {

void print_to_stderr(const gchar* text) {
  std::fputs(text, stderr);
}

/// GLib's own handler puts debugging output, where the user asks for it, on standard output.
void log_to_stderr(const gchar* domain, GLogLevelFlags level, const gchar* text,
                   gpointer /*data*/) {
  if (!g_log_writer_default_would_drop(level, domain)) {
    fmt::print(stderr, "{}: {}\n", domain == nullptr ? "GLib" : domain, text);
  }
}

Result<void> init_once() {
  g_log_set_default_handler(log_to_stderr, nullptr);
  g_set_print_handler(print_to_stderr);
  GError* error = nullptr;
  if (gst_init_check(nullptr, nullptr, &error)) {
    return {};
  }
  return failed(fmt::format("GStreamer does not start: {}", take_text(error)));
}

/// GStreamer names the element inside its sentence only: no element "x264enc".
std::string quoted_part(const std::string& sentence) {
  const auto begin = sentence.find('"');
  const auto end = sentence.find('"', begin + 1);
  return end == std::string::npos ? std::string() : sentence.substr(begin + 1, end - begin - 1);
}

gboolean note_running_task(GstElement* /*element*/, GstPad* pad, gpointer is_running) {
  GST_OBJECT_LOCK(pad);
  const GstTask* task = GST_PAD_TASK(pad);
  if (task != nullptr && GST_TASK_STATE(task) == GST_TASK_STARTED) {
    *static_cast<bool*>(is_running) = true;
  }
  GST_OBJECT_UNLOCK(pad);
  return TRUE;
}

void note_running_tasks(const GValue* item, gpointer is_running) {
  auto* element = static_cast<GstElement*>(g_value_get_object(item));
  gst_element_foreach_pad(element, note_running_task, is_running);
}

Error parse_error(GError* error) {
  const bool is_missing =
      g_error_matches(error, GST_PARSE_ERROR, GST_PARSE_ERROR_NO_SUCH_ELEMENT) != FALSE;
  const std::string sentence = take_text(error);
  return {Error::Kind::bad_input, is_missing ? missing_element_text(quoted_part(sentence))
                                             : fmt::format("GStreamer pipeline: {}", sentence)};
}

}  // namespace

Result<void> init_gstreamer() {
  static const Result<void> started = init_once();
  return started;
}

Result<GstPipelinePtr> parse_pipeline(const std::string& text) {
  GError* error = nullptr;
  GstPipelinePtr pipeline(
      gst_parse_launch_full(text.c_str(), nullptr, GST_PARSE_FLAG_FATAL_ERRORS, &error));
  if (error != nullptr) {
    return tl::unexpected<Error>(parse_error(error));
  }
  gst_object_ref_sink(pipeline.get());
  return pipeline;
}

GstElementPtr element_named(const GstPipelinePtr& pipeline, const char* name) {
  return GstElementPtr(gst_bin_get_by_name(GST_BIN(pipeline.get()), name));
}

bool is_streaming(const GstPipelinePtr& pipeline) {
  bool is_running = false;
  GstIterator* elements = gst_bin_iterate_recurse(GST_BIN(pipeline.get()));
  while (gst_iterator_foreach(elements, note_running_tasks, &is_running) == GST_ITERATOR_RESYNC) {
    gst_iterator_resync(elements);  // an element came or went meanwhile
  }
  gst_iterator_free(elements);
  return is_running;
}

bool is_element_installed(const char* element) {
  GstElementFactory* factory = gst_element_factory_find(element);
  if (factory == nullptr) {
    return false;
  }
  gst_object_unref(factory);
  return true;
}

}  // namespace gimbal

#pragma once

#include <gst/gst.h>

#include <atomic>
#include <cstdint>

namespace gimbal {

/// Counts what elements of a pipeline write that convert pictures: a copy that costs as much as one
/// of ours. Outlives the pipeline.
class ConversionCount {
 public:
  /// Watches the elements that are in the pipeline now.
  void watch(GstElement* pipeline);

  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  static void watch_element(const GValue* item, gpointer count);
  static GstPadProbeReturn on_picture(GstPad* pad, GstPadProbeInfo* probe, gpointer count);

  std::atomic<std::int64_t> bytes_ = 0;
};

}  // namespace gimbal

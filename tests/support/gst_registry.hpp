#pragma once

#include <gst/gst.h>

namespace gimbal::test {

/// Takes an element out of GStreamer's registry, as if it were not installed.
class WithoutElement {
 public:
  explicit WithoutElement(const char* name)
      : feature_(gst_registry_lookup_feature(gst_registry_get(), name)) {
    if (feature_ != nullptr) {
      gst_registry_remove_feature(gst_registry_get(), feature_);
    }
  }
  WithoutElement(const WithoutElement&) = delete;
  WithoutElement& operator=(const WithoutElement&) = delete;
  ~WithoutElement() {
    if (feature_ != nullptr) {
      gst_registry_add_feature(gst_registry_get(), feature_);
      gst_object_unref(feature_);
    }
  }

 private:
  GstPluginFeature* feature_;
};

}  // namespace gimbal::test

#pragma once

#include <gst/gst.h>

#include <string>
#include <string_view>

namespace gimbal {

/// The error's text in one line, without a full stop. Frees `error`.
[[nodiscard]] std::string take_text(GError* error);

/// What an error or warning message on the bus says, in one line with its cause.
[[nodiscard]] std::string message_text(GstMessage* message);

/// Debian's package that brings an element; empty if it is not known here.
[[nodiscard]] std::string_view package_of_element(std::string_view element);

/// Says that an element is not installed, and what to install.
[[nodiscard]] std::string missing_element_text(std::string_view element);

/// Says what a missing-plugin message of decodebin or parsebin asks for, and what to install.
[[nodiscard]] std::string missing_plugin_text(GstMessage* message);

}  // namespace gimbal

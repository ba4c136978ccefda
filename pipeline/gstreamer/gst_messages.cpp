#include "pipeline/gstreamer/gst_messages.hpp"

#include <fmt/format.h>
#include <gst/pbutils/pbutils.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

namespace gimbal {
namespace {

using GlibText = std::unique_ptr<gchar, decltype(&g_free)>;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) {
    text.pop_back();
  }
  return text;
}

/// Elements append a trace to their errors whose last line has the cause, such as the system's own
/// words; the lines before it name source files and objects.
std::string cause_in_trace(const gchar* trace) {
  const std::string text = trace == nullptr ? "" : trace;
  const auto line_end = text.find('\n');
  return line_end == std::string::npos ? std::string() : one_line(text.substr(line_end + 1));
}

/// Without the number that GStreamer gives each element it makes: a pipeline that is opened again
/// and again would say something new each time.
std::string source_name(GstMessage* message) {
  const std::string name = GST_MESSAGE_SRC_NAME(message);
  GstObject* const source = GST_MESSAGE_SRC(message);
  GstElementFactory* const factory =
      GST_IS_ELEMENT(source) ? gst_element_get_factory(GST_ELEMENT(source)) : nullptr;
  if (factory == nullptr) return name;
  const std::string kind = GST_OBJECT_NAME(factory);
  const bool is_numbered = name.starts_with(kind) &&
                           name.find_first_not_of("0123456789", kind.size()) == std::string::npos;
  return is_numbered ? kind : name;
}

constexpr std::string_view kBase = "gstreamer1.0-plugins-base";
constexpr std::string_view kGood = "gstreamer1.0-plugins-good";
constexpr std::string_view kBad = "gstreamer1.0-plugins-bad";
constexpr std::string_view kUgly = "gstreamer1.0-plugins-ugly";
constexpr std::string_view kLibav = "gstreamer1.0-libav";

constexpr std::array kPackages = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"alsasink", "gstreamer1.0-alsa"},
    {"audioconvert", kBase},
    {"audioresample", kBase},
    {"autovideosink", kGood},
    {"avimux", kGood},
    {"decodebin", kBase},
    {"flvmux", kGood},
    {"glimagesink", "gstreamer1.0-gl"},
    {"gtksink", "gstreamer1.0-gtk3"},
    {"h264parse", kBad},
    {"h265parse", kBad},
    {"hlssink2", kBad},
    {"hlssink3", kBad},
    {"jpegenc", kGood},
    {"kmssink", kBad},
    {"matroskamux", kGood},
    {"mp4mux", kGood},
    {"mpegtsmux", kBad},
    {"openh264enc", kBad},
    {"opusenc", kBase},
    {"parsebin", kBase},
    {"pngenc", kGood},
    {"qtmux", kGood},
    {"rtmp2sink", kBad},
    {"rtmpsink", kBad},
    {"rtph264pay", kGood},
    {"rtpjpegpay", kGood},
    {"rtpopuspay", kGood},
    {"rtspclientsink", "gstreamer1.0-rtsp"},
    {"shmsink", kBad},
    {"splitmuxsink", kGood},
    {"srtsink", kBad},
    {"svtav1enc", kBad},
    {"tcpserversink", kBase},
    {"theoraenc", kBase},
    {"udpsink", kGood},
    {"v4l2h264enc", kGood},
    {"v4l2sink", kGood},
    {"vah264enc", kBad},
    {"videoconvert", kBase},
    {"videorate", kBase},
    {"videoscale", kBase},
    {"voaacenc", kBad},
    {"vp8enc", kGood},
    {"vp9enc", kGood},
    {"waylandsink", kBad},
    {"webmmux", kGood},
    {"webrtcbin", kBad},
    {"x264enc", kUgly},
    {"x265enc", kBad},
    {"ximagesink", "gstreamer1.0-x"},
    {"xvimagesink", "gstreamer1.0-x"},
    {"y4menc", kGood},
});

}  // namespace

std::string take_text(GError* error) {
  const std::string text = error->message;
  g_error_free(error);
  return one_line(text);
}

std::string message_text(GstMessage* message) {
  GError* error = nullptr;
  gchar* trace = nullptr;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
    gst_message_parse_warning(message, &error, &trace);
  } else {
    gst_message_parse_error(message, &error, &trace);
  }
  const std::string cause = cause_in_trace(trace);
  g_free(trace);
  const std::string text = fmt::format("{}: {}", source_name(message), take_text(error));
  return cause.empty() ? text : fmt::format("{} ({})", text, cause);
}

std::string_view package_of_element(std::string_view element) {
  if (element.starts_with("avenc_") || element.starts_with("avdec_")) {
    return kLibav;
  }
  const auto* entry = std::find_if(kPackages.begin(), kPackages.end(),
                                   [&](const auto& pair) { return pair.first == element; });
  return entry == kPackages.end() ? std::string_view() : entry->second;
}

std::string missing_element_text(std::string_view element) {
  const std::string_view package = package_of_element(element);
  if (package.empty()) {
    return fmt::format(
        "GStreamer has no element \"{}\" here: check its name, or install its plugin", element);
  }
  return fmt::format("GStreamer's element {} is not installed: apt install {}", element, package);
}

std::string missing_plugin_text(GstMessage* message) {
  const GlibText what(gst_missing_plugin_message_get_description(message), g_free);
  return fmt::format("GStreamer has no \"{}\" here: apt install {}, or {}", what.get(), kLibav,
                     kBad);
}

}  // namespace gimbal

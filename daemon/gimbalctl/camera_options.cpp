#include "daemon/gimbalctl/camera_options.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include "daemon/gimbalctl/picture_size.hpp"
#include "drivers/driver_table.hpp"

namespace gimbal {
namespace {

constexpr std::string_view kLibcamera = "libcamera:";

Result<std::pair<std::string, double>> parse_control(const std::string& text) {
  const auto equals = text.find('=');
  double value = 0;
  if (equals != std::string::npos && equals > 0) {
    const char* const end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data() + equals + 1, end, value);
    if (parsed.ec == std::errc() && parsed.ptr == end) {
      return std::pair(text.substr(0, equals), value);
    }
  }
  return bad_input(fmt::format("--control {}: write NAME=NUMBER", text));
}

/// What all drivers take.
Result<void> set_common(const CameraOptions& options, LiveCameraSettings& settings) {
  if (options.fps != 0) settings.fps = options.fps;
  if (options.size.empty()) return {};
  const auto size = parse_picture_size(options.size);
  if (!size) return tl::unexpected(size.error());
  settings.size = *size;
  return {};
}

}  // namespace

CLI::Option* add_camera_options(CLI::App& command, CameraOptions& options) {
  CLI::Option* const camera = command.add_option(
      "--camera", options.camera,
      "A camera: /dev/video0, its name or bus as `gimbalctl devices` shows them, or "
      "libcamera:NAME");
  command.add_option("--size", options.size, "WIDTHxHEIGHT that the camera is set to")
      ->needs(camera);
  command.add_option("--fps", options.fps, "Pictures a second that the camera is set to")
      ->needs(camera);
  command
      .add_option("--control", options.controls,
                  "NAME=NUMBER: a control of the camera, such as exposure_time_absolute=10")
      ->needs(camera);
  return camera;
}

Result<std::unique_ptr<CameraSource>> make_camera(const CameraOptions& options) {
  CameraSettings settings;
  const bool is_libcamera = options.camera.starts_with(kLibcamera);
  settings.driver = is_libcamera ? CameraDriver::libcamera : CameraDriver::v4l2;
  if (is_libcamera) {
    settings.libcamera.camera = options.camera.substr(kLibcamera.size());
  } else {
    settings.v4l2.device = options.camera;
  }
  for (const std::string& text : options.controls) {
    const auto control = parse_control(text);
    if (!control) return tl::unexpected(control.error());
    settings.v4l2.controls[control->first] = std::lround(control->second);
    settings.libcamera.controls[control->first] = {control->second};
  }
  LiveCameraSettings& common =
      is_libcamera ? static_cast<LiveCameraSettings&>(settings.libcamera) : settings.v4l2;
  if (auto set = set_common(options, common); !set) return tl::unexpected(set.error());
  return open_camera(settings);
}

}  // namespace gimbal

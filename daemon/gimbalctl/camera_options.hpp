#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A camera as the command line names one.
struct CameraOptions {
  std::string camera;                 ///< empty: none
  std::string size;                   ///< empty: as the camera is set
  double fps = 0;                     ///< 0: as the camera is set
  std::vector<std::string> controls;  ///< NAME=VALUE
};

/// --camera, --size, --fps and --control; the option --camera, which the others need.
CLI::Option* add_camera_options(CLI::App& command, CameraOptions& options);

/// bad_input for words that are no size or no value, and what the driver says of its settings. The
/// device is opened when the camera is started.
[[nodiscard]] Result<std::unique_ptr<CameraSource>> make_camera(const CameraOptions& options);

}  // namespace gimbal

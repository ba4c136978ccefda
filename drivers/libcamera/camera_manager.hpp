#pragma once

#include <libcamera/libcamera.h>

#include <memory>
#include <string>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// The running camera manager. libcamera allows a program only one at a time, so all who hold it
/// share it, and it ends with the last of them.
[[nodiscard]] Result<std::shared_ptr<libcamera::CameraManager>> camera_manager();

/// As the sensor calls itself; the id where it does not.
[[nodiscard]] std::string model_of(const libcamera::Camera& camera);

/// `wanted`: an id, a model, or empty for the first.
[[nodiscard]] Result<std::shared_ptr<libcamera::Camera>> find_camera(
    libcamera::CameraManager& manager, const std::string& wanted);

}  // namespace gimbal

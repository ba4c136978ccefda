#include "drivers/libcamera/camera_manager.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <mutex>
#include <system_error>
#include <utility>
#include <vector>

namespace gimbal {

namespace {

constexpr int kKeepWhatIsSet = 0;

}  // namespace

Result<std::shared_ptr<libcamera::CameraManager>> camera_manager() {
  static std::mutex mutex;
  static std::weak_ptr<libcamera::CameraManager> running;
  const std::lock_guard lock(mutex);
  if (auto manager = running.lock()) return manager;
  setenv("LIBCAMERA_LOG_LEVELS", "ERROR", kKeepWhatIsSet);  // it tells all it does otherwise
  auto manager = std::make_unique<libcamera::CameraManager>();
  if (const int error = manager->start(); error != 0) {
    return failed("libcamera does not start: " + std::generic_category().message(-error));
  }
  std::shared_ptr<libcamera::CameraManager> shared(manager.release(),
                                                   [](libcamera::CameraManager* ended) {
                                                     ended->stop();
                                                     delete ended;
                                                   });
  running = shared;
  return shared;
}

std::string model_of(const libcamera::Camera& camera) {
  const auto model = camera.properties().get(libcamera::properties::Model);
  return model ? std::string(*model) : camera.id();
}

Result<std::shared_ptr<libcamera::Camera>> find_camera(libcamera::CameraManager& manager,
                                                       const std::string& wanted) {
  std::vector<std::string> others;
  for (const auto& camera : manager.cameras()) {
    const std::string model = model_of(*camera);
    if (wanted.empty() || camera->id() == wanted || model == wanted) return camera;
    others.push_back(fmt::format("{} ({})", camera->id(), model));
  }
  if (others.empty()) {
    return bad_input(
        "libcamera finds no camera; is the sensor in the device tree, and may this user open "
        "/dev/media* and /dev/video* (group video)?");
  }
  return bad_input(
      fmt::format("libcamera has no camera '{}'; there is {}", wanted, fmt::join(others, ", ")));
}

}  // namespace gimbal

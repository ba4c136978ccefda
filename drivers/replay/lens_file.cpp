#include "drivers/replay/lens_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <utility>

#include "drivers/replay/lens_formats.hpp"
#include "pipeline/lens/lens.hpp"

namespace gimbal {
namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Result<LensFile> checked(LensFile file) {
  constexpr int kLargestSide_px = 65535;
  const ImageSize size = file.camera.size;
  if (std::min(size.width, size.height) < 1 ||
      std::max(size.width, size.height) > kLargestSide_px) {
    return bad_input(fmt::format("a picture of {}x{} is no size", size.width, size.height));
  }
  return Lens::create(file.camera.lens).map([&](const Lens&) { return std::move(file); });
}

}  // namespace

bool is_lens_file(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".json" || extension == ".yaml" || extension == ".yml";
}

Result<LensFile> read_lens_file(const std::filesystem::path& path) {
  auto file =
      extension_of(path) == ".json" ? read_gyroflow_profile(path) : read_calibration_yaml(path);
  return std::move(file).and_then(checked).map_error([&](Error error) {
    error.message = fmt::format("{}: {}", path.string(), error.message);
    return error;
  });
}

Result<CameraCalibration> fitted_to(CameraCalibration camera, ImageSize size) {
  constexpr double kSameShape = 0.01;
  const double ratio = static_cast<double>(size.width) / camera.size.width;
  const double down = static_cast<double>(size.height) / camera.size.height;
  if (!(std::abs(ratio / down - 1) <= kSameShape)) {
    return bad_input(fmt::format(
        "pictures are {}x{}, the calibration is for {}x{}: set a size of that shape, or "
        "calibrate for this one",
        size.width, size.height, camera.size.width, camera.size.height));
  }
  Eigen::Matrix3d& K = camera.lens.K;
  K(0, 0) *= ratio;
  K(1, 1) *= ratio;
  K(0, 2) = (K(0, 2) + 0.5) * ratio - 0.5;
  K(1, 2) = (K(1, 2) + 0.5) * ratio - 0.5;
  camera.size = size;
  return camera;
}

}  // namespace gimbal

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "drivers/replay/lens_formats.hpp"

namespace gimbal {
namespace {

using Json = nlohmann::json;

/// A member, or null.
const Json& member(const Json& object, const char* key) {
  static const Json null;
  if (!object.is_object()) return null;
  const auto found = object.find(key);
  return found == object.end() ? null : *found;
}

Result<ImageSize> read_size(const Json& profile) {
  const Json& size = member(profile, "calib_dimension");
  const Json& width = member(size, "w");
  const Json& height = member(size, "h");
  if (!width.is_number_integer() || !height.is_number_integer()) {
    return bad_input("calib_dimension: two whole numbers, w and h, are expected");
  }
  return ImageSize{width.get<int>(), height.get<int>()};
}

Result<LensModel> read_model(const Json& profile) {
  const Json& name = member(profile, "distortion_model");
  const bool is_plain = member(profile, "use_opencv_standard") == true &&
                        member(profile, "use_opencv_fisheye") != true;
  const std::string model = name.is_string() ? name.get<std::string>()
                            : is_plain       ? "opencv_standard"
                                             : "opencv_fisheye";
  if (model == "opencv_fisheye") return LensModel::fisheye;
  if (model == "opencv_standard") return LensModel::brown;
  return bad_input(fmt::format(
      "distortion_model \"{}\" is not known; opencv_fisheye and opencv_standard are", model));
}

Result<Eigen::Matrix3d> read_K(const Json& profile, const Json& parameters, ImageSize size) {
  const Json& rows = member(parameters, "camera_matrix");
  Eigen::Matrix3d K;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const bool is_there = rows.is_array() && rows.size() == 3 && rows[row].is_array() &&
                            rows[row].size() == 3 && rows[row][column].is_number();
      if (!is_there) return bad_input("camera_matrix: three rows of three numbers are expected");
      K(static_cast<int>(row), static_cast<int>(column)) = rows[row][column].get<double>();
    }
  }
  if (member(profile, "asymmetrical") != true) {
    K(0, 2) = (size.width - 1) / 2.0;
    K(1, 2) = (size.height - 1) / 2.0;
  }
  return K;
}

/// Gyroflow can also stretch, and undo what an action camera has done to its picture.
Result<void> refuse_what_is_more(const Json& profile) {
  const Json& stretch = member(profile, "input_horizontal_stretch");
  if (stretch.is_number() && stretch != 0 && stretch != 1) {
    return bad_input("input_horizontal_stretch: anamorphic lenses are not supported");
  }
  const Json& digital = member(profile, "digital_lens");
  if (digital.is_string() && !digital.get<std::string>().empty()) {
    return bad_input(fmt::format("digital_lens \"{}\" is not supported; record without it",
                                 digital.get<std::string>()));
  }
  return {};
}

}  // namespace

Result<LensFile> read_gyroflow_profile(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) return bad_input("cannot be read");
  const Json profile = Json::parse(stream, nullptr, false);
  if (!profile.is_object()) return bad_input("not a JSON object");
  if (auto refused = refuse_what_is_more(profile); !refused) {
    return tl::unexpected(refused.error());
  }
  const auto size = read_size(profile);
  if (!size) return tl::unexpected(size.error());
  const auto model = read_model(profile);
  if (!model) return tl::unexpected(model.error());
  const Json& parameters = member(profile, "fisheye_params");
  const auto K = read_K(profile, parameters, *size);
  if (!K) return tl::unexpected(K.error());
  LensFile file;
  file.camera.size = *size;
  file.camera.lens.model = *model;
  file.camera.lens.K = *K;
  for (const Json& coefficient : member(parameters, "distortion_coeffs")) {
    if (!coefficient.is_number()) return bad_input("distortion_coeffs: numbers are expected");
    file.camera.lens.distortion.push_back(coefficient.get<double>());
  }
  const Json& readout_ms = member(profile, "frame_readout_time");
  if (readout_ms.is_number()) {
    file.camera.readout = duration_from_seconds(readout_ms.get<double>() * 1e-3);
  }
  const Json& fps = member(profile, "fps");
  if (fps.is_number()) file.camera.fps = fps.get<double>();
  return file;
}

}  // namespace gimbal

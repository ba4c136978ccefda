#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/replay/lens_formats.hpp"

namespace gimbal {
namespace {

using Numbers = std::vector<double>;

/// OpenCV's first line, "%YAML:1.0", is not YAML's own.
std::string without_directive(std::string text) {
  if (text.starts_with("%YAML:")) text.erase(0, std::min(text.find('\n'), text.size()));
  return text;
}

template <typename T>
Result<T> read(const YAML::Node& node, const char* key, const char* expected) {
  try {
    if (node[key]) return node[key].as<T>();
  } catch (const YAML::Exception&) {
    // Said below.
  }
  return bad_input(fmt::format("{}: is missing or wrong; {} expected", key, expected));
}

/// A matrix as OpenCV and ROS have it: the numbers are under `data`, row by row.
Result<Numbers> read_matrix(const YAML::Node& node, const char* key) {
  if (node[key] && node[key].IsMap()) return read<Numbers>(node[key], "data", "numbers are");
  return read<Numbers>(node, key, "a matrix with data is");
}

/// OpenCV writes more coefficients than the model here has; those may be zero.
Numbers without_zeros_past(std::size_t count, Numbers numbers) {
  while (numbers.size() > count && numbers.back() == 0) numbers.pop_back();
  return numbers;
}

Result<LensParameters> lens_of(const std::string& model, Numbers coefficients) {
  LensParameters lens;
  if (model == "equidistant" || model == "fisheye") {
    lens.model = LensModel::fisheye;
    lens.distortion = without_zeros_past(4, std::move(coefficients));
  } else if (model == "plumb_bob" || model == "rational_polynomial" || model == "radtan") {
    lens.model = LensModel::brown;
    lens.distortion = without_zeros_past(8, std::move(coefficients));
  } else if (model != "none" && !model.empty()) {
    return bad_input(
        fmt::format("distortion_model \"{}\" is not known; plumb_bob, rational_polynomial, radtan, "
                    "equidistant, "
                    "fisheye and none are",
                    model));
  }
  return lens;
}

/// OpenCV's and ROS' calibrators.
Result<LensFile> read_camera_info(const YAML::Node& root) {
  const auto width = read<int>(root, "image_width", "a whole number is");
  const auto height = read<int>(root, "image_height", "a whole number is");
  const auto K = read_matrix(root, "camera_matrix");
  const auto coefficients = read_matrix(root, "distortion_coefficients");
  if (!width) return tl::unexpected(width.error());
  if (!height) return tl::unexpected(height.error());
  if (!K) return tl::unexpected(K.error());
  if (!coefficients) return tl::unexpected(coefficients.error());
  if (K->size() != 9) return bad_input("camera_matrix: nine numbers are expected");
  // OpenCV's own program does not name the model, but says when it is the fisheye one.
  const bool is_fisheye = root["fisheye_model"] && root["fisheye_model"].as<int>(0) != 0;
  const auto lens =
      lens_of(root["distortion_model"].as<std::string>(is_fisheye ? "fisheye" : "plumb_bob"),
              *coefficients);
  if (!lens) return tl::unexpected(lens.error());
  LensFile file;
  file.camera.size = {*width, *height};
  file.camera.lens = *lens;
  file.camera.lens.K = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(K->data());
  return file;
}

Result<Eigen::Matrix3d> read_R_camera_imu(const YAML::Node& camera) {
  const auto rows =
      read<std::vector<Numbers>>(camera, "T_cam_imu", "four rows of four numbers are");
  if (!rows) return tl::unexpected(rows.error());
  Eigen::Matrix3d R;
  for (std::size_t row = 0; row < 3; ++row) {
    if (rows->size() != 4 || (*rows)[row].size() != 4) {
      return bad_input("T_cam_imu: four rows of four numbers are expected");
    }
    for (std::size_t column = 0; column < 3; ++column) {
      R(static_cast<int>(row), static_cast<int>(column)) = (*rows)[row][column];
    }
  }
  return R;
}

Result<LensFile> read_kalibr(const YAML::Node& camera) {
  const auto model = read<std::string>(camera, "camera_model", "a name is");
  if (!model) return tl::unexpected(model.error());
  if (*model != "pinhole") {
    return bad_input(
        fmt::format("camera_model \"{}\" is not supported; calibrate with pinhole-radtan or "
                    "pinhole-equi",
                    *model));
  }
  const auto k = read<Numbers>(camera, "intrinsics", "four numbers, fu fv pu pv, are");
  const auto size = read<std::vector<int>>(camera, "resolution", "width and height are");
  if (!k) return tl::unexpected(k.error());
  if (!size) return tl::unexpected(size.error());
  if (k->size() != 4) return bad_input("intrinsics: four numbers, fu fv pu pv, are expected");
  if (size->size() != 2) return bad_input("resolution: width and height are expected");
  const auto lens = lens_of(camera["distortion_model"].as<std::string>("none"),
                            camera["distortion_coeffs"].as<Numbers>(Numbers{}));
  if (!lens) return tl::unexpected(lens.error());
  LensFile file;
  file.camera.size = {(*size)[0], (*size)[1]};
  file.camera.lens = *lens;
  file.camera.lens.K << (*k)[0], 0, (*k)[2], 0, (*k)[1], (*k)[3], 0, 0, 1;
  file.camera.time_offset = duration_from_seconds(camera["timeshift_cam_imu"].as<double>(0));
  if (!camera["T_cam_imu"]) return file;
  return read_R_camera_imu(camera).map([&](const Eigen::Matrix3d& R) {
    file.R_camera_imu = R;
    return file;
  });
}

}  // namespace

Result<LensFile> read_calibration_yaml(const std::filesystem::path& path) {
  const std::ifstream stream(path);
  if (!stream) return bad_input("cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  try {
    const YAML::Node root = YAML::Load(without_directive(text.str()));
    if (root.IsMap() && root["cam0"]) return read_kalibr(root["cam0"]);
    if (root.IsMap() && root["camera_matrix"]) return read_camera_info(root);
  } catch (const YAML::Exception& error) {
    return bad_input(fmt::format("line {}: {}", error.mark.line + 1, error.msg));
  }
  return bad_input("neither cam0 (Kalibr) nor camera_matrix (OpenCV, ROS) is in it");
}

}  // namespace gimbal

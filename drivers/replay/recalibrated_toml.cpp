#include "drivers/replay/recalibrated_toml.hpp"

#include <toml++/toml.h>

#include <sstream>
#include <utility>

#include "drivers/replay/calibration_keys.hpp"

namespace gimbal {
namespace {

toml::array rows_of(const Eigen::Matrix3d& matrix) {
  toml::array rows;
  for (Eigen::Index row = 0; row < 3; ++row) {
    rows.push_back(toml::array{matrix(row, 0), matrix(row, 1), matrix(row, 2)});
  }
  return rows;
}

toml::array list_of(const std::vector<double>& values) {
  toml::array list;
  for (const double value : values) list.push_back(value);
  return list;
}

toml::table& table_in(toml::table& root, std::string_view name) {
  if (root[name].as_table() == nullptr) root.insert_or_assign(name, toml::table{});
  return *root[name].as_table();
}

}  // namespace

Result<std::string> recalibrated_toml(std::string_view session_toml,
                                      const FittedCalibration& fitted) {
  toml::table root;
  try {
    root = toml::parse(session_toml);
  } catch (const toml::parse_error& error) {
    return bad_input("session.toml: " + std::string(error.description()));
  }
  const auto set = [&](std::string_view table, std::string_view key, auto&& value) {
    table_in(root, table).insert_or_assign(key, std::forward<decltype(value)>(value));
  };
  if (fitted.size) {
    set("camera", "width", fitted.size->width);
    set("camera", "height", fitted.size->height);
  }
  if (fitted.lens) {
    set("camera", "model", name_of(lens_model_names(), fitted.lens->model));
    set("camera", "K", rows_of(fitted.lens->K));
    set("camera", "distortion", list_of(fitted.lens->distortion));
  }
  if (fitted.K) set("camera", "K", rows_of(*fitted.K));
  if (fitted.readout) set("camera", "readout_s", to_seconds(*fitted.readout));
  if (fitted.time_offset) set("camera", "time_offset_s", to_seconds(*fitted.time_offset));
  if (fitted.R_camera_imu) set("imu", "R_camera_imu", rows_of(*fitted.R_camera_imu));
  std::ostringstream text;
  text << root << "\n";
  return text.str();
}

}  // namespace gimbal

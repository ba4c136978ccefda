#include "drivers/iio/axes.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <charconv>
#include <optional>
#include <string>

namespace gimbal {
namespace {

constexpr double kOrthonormalWithin = 1e-2;

std::optional<double> take_number(std::string_view& text) {
  const auto begin = text.find_first_not_of(" \n");
  if (begin == std::string_view::npos) return std::nullopt;
  text.remove_prefix(begin);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

bool take_separator(std::string_view& text, char separator) {
  const auto begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos || text[begin] != separator) return false;
  text.remove_prefix(begin + 1);
  return true;
}

std::optional<Eigen::Matrix3d> take_matrix(std::string_view text) {
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 9; ++i) {
    if (i > 0 && !take_separator(text, i % 3 == 0 ? ';' : ',')) return std::nullopt;
    const auto number = take_number(text);
    if (!number) return std::nullopt;
    matrix(i / 3, i % 3) = *number;
  }
  const bool has_ended = text.find_first_not_of(" \n") == std::string_view::npos;
  return has_ended ? std::optional(matrix) : std::nullopt;
}

bool is_rotation(const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix3d difference = matrix * matrix.transpose() - Eigen::Matrix3d::Identity();
  return difference.cwiseAbs().maxCoeff() < kOrthonormalWithin && matrix.determinant() > 0;
}

}  // namespace

Result<Eigen::Matrix3d> parse_mount_matrix(std::string_view text) {
  const auto matrix = take_matrix(text);
  if (!matrix)
    return bad_input(fmt::format("mount matrix \"{}\" is not three rows of three", text));
  if (!is_rotation(*matrix)) {
    return bad_input(fmt::format(
        "mount matrix \"{}\" is no rotation; correct it in the device tree or hwdb", text));
  }
  return *matrix;
}

}  // namespace gimbal

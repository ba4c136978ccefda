#include "tests/support/orientation_trial.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace gimbal::test {
namespace {

/// Rows of numbers under a line of names.
std::vector<std::vector<double>> read_numbers(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error(path.string() + " cannot be read");
  std::string line;
  std::getline(file, line);
  std::vector<std::vector<double>> rows;
  while (std::getline(file, line)) {
    std::vector<double>& row = rows.emplace_back();
    for (const char* next = line.c_str(); *next != '\0';) {
      char* end = nullptr;
      row.push_back(std::strtod(next, &end));
      next = *end == ',' ? end + 1 : end;
    }
  }
  return rows;
}

Eigen::Vector3d axes_of(const std::vector<double>& row) {
  return {row.at(1), row.at(2), row.at(3)};
}

}  // namespace

OrientationTrial read_orientation_trial(const std::filesystem::path& folder) {
  const auto gyro = read_numbers(folder / "gyro.csv");
  const auto accel = read_numbers(folder / "accel.csv");
  OrientationTrial trial{folder.filename().string(), {}, {}};
  for (std::size_t i = 0; i < gyro.size(); ++i) {
    trial.samples.push_back(
        {time_from_seconds(gyro[i].at(0)), axes_of(gyro[i]), axes_of(accel.at(i))});
  }
  trial.truth.resize(gyro.size());
  const double half_interval_s =
      (gyro.back()[0] - gyro.front()[0]) / (2.0 * static_cast<double>(gyro.size()));
  std::size_t at = 0;
  for (const std::vector<double>& row : read_numbers(folder / "truth.csv")) {
    while (at < gyro.size() && gyro[at][0] < row.at(0) - half_interval_s) ++at;
    if (at == gyro.size()) break;
    if (gyro[at][0] > row[0] + half_interval_s || !std::isfinite(row.at(1))) continue;
    trial.truth[at] = {Eigen::Quaterniond(row[1], row.at(2), row.at(3), row.at(4)).normalized(),
                       row.at(5) > 0.5};
  }
  return trial;
}

std::vector<std::filesystem::path> orientation_trials(const std::filesystem::path& shared,
                                                      const std::string& prefix) {
  std::vector<std::filesystem::path> folders;
  const std::filesystem::path all = shared / "data/orientation";
  if (!std::filesystem::exists(all)) return folders;
  for (const auto& entry : std::filesystem::directory_iterator(all)) {
    if (entry.path().filename().string().starts_with(prefix)) folders.push_back(entry.path());
  }
  std::ranges::sort(folders);
  return folders;
}

}  // namespace gimbal::test

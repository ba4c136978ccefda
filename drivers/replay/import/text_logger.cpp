#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "drivers/replay/csv.hpp"
#include "drivers/replay/import/importer.hpp"
#include "drivers/replay/import/phone.hpp"
#include "drivers/replay/stamped_log.hpp"
#include "pipeline/sample/imu_sample.hpp"

namespace gimbal {

namespace {

constexpr std::array<const char*, 2> kAccelNames{"acce.txt", "accel.txt"};

bool is_file(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

/// The first line that is neither empty nor a comment, as far as its first 500 bytes.
std::string first_row(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 500> line{};
  for (int i = 0; i < 100 && file.getline(line.data(), std::ssize(line)); ++i) {
    const std::string_view text(line.data());
    if (!text.empty() && text.front() != '#' && text.front() != '\r') return std::string(text);
  }
  return {};
}

char separator_of(const std::string& row) {
  return row.find(',') != std::string::npos ? ',' : ' ';
}

/// True for a row of `columns` numbers, the first of them whole and in nanoseconds since a boot or
/// an epoch: a day has 8.6e13.
bool is_row_in_nanoseconds(const std::string& row, std::size_t columns) {
  constexpr double kLeast = 1e11;
  std::size_t count = 0;
  for (std::size_t begin = 0; begin < row.size();) {
    const std::size_t end = std::min(row.find_first_of(", \t\r", begin), row.size());
    if (end > begin) {
      const auto value = parse_number(std::string_view(row).substr(begin, end - begin));
      if (!value || (count == 0 && (*value < kLeast || *value != std::floor(*value)))) return false;
      ++count;
    }
    begin = end + 1;
  }
  return count == columns;
}

/// Time and three numbers, the first of these in column `first`, counted from 0.
template <typename Sample>
Result<std::vector<Sample>> read_samples(const std::filesystem::path& path, std::size_t first,
                                         double factor, std::vector<std::string>& warnings) {
  Result<CsvReader> reader =
      CsvReader::open_headerless(path, {{"t", 0}, {"x", first}, {"y", first + 1}, {"z", first + 2}},
                                 separator_of(first_row(path)));
  if (!reader) return tl::unexpected(reader.error());
  Result<StampedLog<Sample>> log =
      read_vectors<Sample>(*reader, {TimeUnit::nanoseconds, factor}, warnings);
  if (!log) return tl::unexpected(log.error());
  if (Result<void> usable = check_has_samples(*log); !usable) return tl::unexpected(usable.error());
  return std::move(log->samples);
}

/// 1 if the numbers are m/s², 9.80665 if they are g: whoever holds a phone feels gravity.
double unit_m_s2(const std::vector<AccelSample>& accel) {
  constexpr double kBetween = 4.0;
  std::vector<double> magnitudes;
  magnitudes.reserve(accel.size());
  for (const AccelSample& sample : accel) magnitudes.push_back(sample.accel_m_s2.norm());
  const auto middle = magnitudes.begin() + std::ssize(magnitudes) / 2;
  std::nth_element(magnitudes.begin(), middle, magnitudes.end());
  return *middle < kBetween ? kStandardGravity_m_s2 : 1.0;
}

/// gyro.txt and acce.txt of an iPhone, with CoreMotion's sign.
Result<Session> read_core_motion_logs(const std::filesystem::path& input) {
  Session session;
  auto gyro = read_samples<GyroSample>(input / "gyro.txt", 1, 1.0, session.warnings);
  if (!gyro) return tl::unexpected(gyro.error());
  session.gyro = std::move(*gyro);
  for (const char* name : kAccelNames) {
    if (!is_file(input / name) || !session.accel.empty()) continue;
    auto accel = read_samples<AccelSample>(input / name, 1, -1.0, session.warnings);
    if (!accel) return tl::unexpected(accel.error());
    session.accel = std::move(*accel);
    const double unit = unit_m_s2(session.accel);
    for (AccelSample& sample : session.accel) sample.accel_m_s2 *= unit;
  }
  session.device = "iPhone";
  session.imu.R_camera_imu = R_landscape_camera_phone();
  session.imu_clock = "boot";
  session.notes = {
      "From a CoreLocationMotion logger folder. The accelerometer is taken to have CoreMotion's "
      "sign."};
  return session;
}

bool has_core_motion_logs(const std::filesystem::path& input) {
  return is_file(input / "gyro.txt") && is_row_in_nanoseconds(first_row(input / "gyro.txt"), 4);
}

/// One file of an Android phone: t wx wy wz ax ay az, +g up at rest.
Result<Session> read_android_log(const std::filesystem::path& input) {
  Session session;
  auto gyro = read_samples<GyroSample>(input, 1, 1.0, session.warnings);
  if (!gyro) return tl::unexpected(gyro.error());
  auto accel = read_samples<AccelSample>(input, 4, 1.0, session.warnings);
  if (!accel) return tl::unexpected(accel.error());
  session.gyro = std::move(*gyro);
  session.accel = std::move(*accel);
  session.device = "Android phone";
  session.imu.R_camera_imu = R_landscape_camera_phone();
  session.imu_clock = "boot";
  session.notes = {"From an Android log: t wx wy wz ax ay az in nanoseconds, rad/s and m/s2."};
  return session;
}

bool is_android_log(const std::filesystem::path& input) {
  return is_file(input) && is_row_in_nanoseconds(first_row(input), 7);
}

}  // namespace

const Importer kCoreMotionLogImporter{"folder with gyro.txt and acce.txt in nanoseconds",
                                      has_core_motion_logs, read_core_motion_logs};
const Importer kAndroidLogImporter{"text file with lines t wx wy wz ax ay az in nanoseconds",
                                   is_android_log, read_android_log};

}  // namespace gimbal

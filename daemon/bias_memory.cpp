#include "daemon/bias_memory.hpp"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "daemon/journal.hpp"
#include "daemon/state_folder.hpp"

namespace gimbal {
namespace {

/// A power cut costs what was learned since, at most.
constexpr std::chrono::minutes kPeriod{5};
constexpr double kDegree = std::numbers::pi / 180;

/// Of devices of this computer; a recording has its own, which are not known to be these.
std::filesystem::path usual_file(const Configuration& configuration, const std::string& imu) {
  if (configuration.source == SourceKind::replay) return {};
  return state_folder() / fmt::format("gyro-bias-{}.toml", imu);
}

}  // namespace

BiasMemory::BiasMemory(std::filesystem::path file, std::chrono::seconds longest_age,
                       std::string imu)
    : file_(std::move(file)), longest_age_(longest_age), imu_(std::move(imu)) {}

std::optional<GyroBias> BiasMemory::recall(WallTime now) const {
  if (file_.empty()) return std::nullopt;
  const auto read = read_bias_file(file_);
  if (!read) {
    log_line(LogLevel::warning, read.error().message + "; the gyroscope's bias is learned anew");
    return std::nullopt;
  }
  if (!*read || (*read)->imu != imu_) return std::nullopt;
  // A computer without a clock of its own may be set back, but not for long.
  const std::chrono::seconds age = std::chrono::abs(now - (*read)->time);
  if (age > longest_age_) return std::nullopt;
  const Eigen::Vector3d& bias = (*read)->bias.bias_rad_s;
  log_line(LogLevel::info,
           fmt::format("the gyroscope's bias was {:.2f}, {:.2f}, {:.2f} deg/s {:.1f} h ago",
                       bias.x() / kDegree, bias.y() / kDegree, bias.z() / kDegree,
                       std::chrono::duration<double, std::ratio<3600>>(age).count()));
  return (*read)->bias;
}

void BiasMemory::keep(const std::optional<GyroBias>& bias, WallTime now) {
  if (!last_written_) last_written_ = now;  // a run's first minutes have little to tell
  if (bias && std::chrono::abs(now - *last_written_) >= kPeriod) write(*bias, now);
}

void BiasMemory::keep_last(const std::optional<GyroBias>& bias, WallTime now) {
  if (bias) write(*bias, now);
}

void BiasMemory::write(const GyroBias& bias, WallTime now) {
  if (file_.empty()) return;
  last_written_ = now;
  auto written = write_bias_file(file_, {imu_, now, bias});
  if (!written && !std::exchange(has_complained_, true)) {
    log_line(LogLevel::warning,
             written.error().message + "; the gyroscope's bias is not kept for the next run");
  }
}

BiasMemory bias_memory_for(const Configuration& configuration) {
  const BiasMemorySettings& settings = configuration.bias_memory;
  const std::string imu = imu_name(configuration);
  return {settings.file.value_or(usual_file(configuration, imu)), settings.longest_age, imu};
}

}  // namespace gimbal

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/replay/csv.hpp"
#include "drivers/replay/decimal_time.hpp"
#include "pipeline/sample/imu_sample.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Stamped samples as a file has them, and the line that each was found on, for messages.
template <typename Sample>
struct StampedLog {
  std::filesystem::path file;
  std::vector<Sample> samples;
  std::vector<std::int64_t> lines;
  std::size_t rows_not_finite = 0;  ///< left out
};

using GyroLog = StampedLog<GyroSample>;
using AccelLog = StampedLog<AccelSample>;
using FrameLog = StampedLog<FrameStamp>;

/// How a log of vectors is written down.
struct VectorLogFormat {
  TimeUnit time_unit = TimeUnit::seconds;
  double factor = 1.0;  ///< what a number has to be multiplied by
};

/// Reads rows of a time and three numbers: the first four columns of `reader`. `Sample` is
/// GyroSample or AccelSample. Rows with values that are not finite are left out and counted in
/// `warnings`.
template <typename Sample>
[[nodiscard]] Result<StampedLog<Sample>> read_vectors(CsvReader& reader,
                                                      const VectorLogFormat& format,
                                                      std::vector<std::string>& warnings);

/// Each reads a CSV file of a session folder (SESSION_FORMAT.md). Rows with values that are not
/// finite are left out and counted in `warnings`. Errors name file, line, column and what was
/// found.
[[nodiscard]] Result<GyroLog> read_gyro_csv(const std::filesystem::path& path,
                                            std::vector<std::string>& warnings);

/// `to_specific_force_m_s2` is what a number of the file has to be multiplied by.
[[nodiscard]] Result<AccelLog> read_accel_csv(const std::filesystem::path& path,
                                              double to_specific_force_m_s2,
                                              std::vector<std::string>& warnings);

[[nodiscard]] Result<FrameLog> read_frames_csv(const std::filesystem::path& path,
                                               std::vector<std::string>& warnings);

/// Keeps the longest run of samples, not necessarily neighbours, whose stamps rise strictly: a
/// clock that leaps ahead for one sample costs that sample, not all that follow. Says what was left
/// out.
template <typename Sample>
void keep_rising_stamps(StampedLog<Sample>& log, std::vector<std::string>& warnings);

/// Refuses a log without samples.
template <typename Sample>
[[nodiscard]] Result<void> check_has_samples(const StampedLog<Sample>& log);

/// Steps between stamps that a log of seconds can have.
struct PlausibleStep {
  double shortest_s;
  double longest_s;
};
inline constexpr PlausibleStep kPlausibleImuStep{5e-5, 0.25};
inline constexpr PlausibleStep kPlausibleFrameStep{5e-4, 1.5};

/// Refuses stamps that cannot be seconds, and says what they seem to be. Takes rising stamps.
template <typename Sample>
[[nodiscard]] Result<void> check_stamps_are_seconds(const StampedLog<Sample>& log,
                                                    PlausibleStep plausible);

/// Says where stamps are further apart than `longest_in_medians` times their median step.
template <typename Sample>
void report_gaps(const StampedLog<Sample>& log, double longest_in_medians,
                 std::vector<std::string>& warnings);

/// Median step between neighbours; zero for fewer than two.
template <typename Sample>
[[nodiscard]] SensorDuration median_step(const std::vector<Sample>& samples);

}  // namespace gimbal

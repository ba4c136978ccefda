#include "drivers/replay/stamped_log.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <utility>

#include "drivers/replay/csv.hpp"

namespace gimbal {

namespace {

std::string name_of(const std::filesystem::path& file) {
  return file.filename().string();
}

std::string_view plural(std::size_t count) {
  return count == 1 ? "" : "s";
}

/// Lines that something is wrong with, for one warning about all of them.
struct LineTally {
  std::size_t count = 0;
  std::int64_t first_line = 0;

  void add(std::int64_t line) {
    if (count++ == 0) first_line = line;
  }
};

void report_not_finite(const std::filesystem::path& file, const LineTally& tally,
                       std::vector<std::string>& warnings) {
  if (tally.count == 0) return;
  warnings.push_back(
      fmt::format("{}: {} row{} left out with values that are not finite, first on line {}",
                  name_of(file), tally.count, plural(tally.count), tally.first_line));
}

void report_cut_end(const std::filesystem::path& file, const CsvReader& reader,
                    std::vector<std::string>& warnings) {
  if (!reader.ended_early()) return;
  warnings.push_back(fmt::format("{}: the last line is cut off and left out", name_of(file)));
}

struct VectorRow {
  SensorTime time;
  Eigen::Vector3d value;
};

/// A row of a time and three numbers; nothing if one of them is not finite.
Result<std::optional<VectorRow>> read_vector_row(const CsvReader& reader, const CsvRow& row,
                                                 const VectorLogFormat& format) {
  const Result<std::optional<SensorDuration>> time = reader.time(row, 0, format.time_unit);
  if (!time) return tl::unexpected(time.error());
  VectorRow out{SensorTime(time->value_or(SensorDuration{})), Eigen::Vector3d::Zero()};
  for (int axis = 0; axis < 3; ++axis) {
    const Result<double> value = reader.number(row, static_cast<std::size_t>(axis) + 1);
    if (!value) return tl::unexpected(value.error());
    out.value[axis] = *value * format.factor;
  }
  if (!*time || !out.value.allFinite()) return std::optional<VectorRow>();
  return std::optional(out);
}

/// A row index,t_s[,exposure_s]; nothing if the time is not finite. An exposure that is empty, not
/// finite or negative counts as unknown.
Result<std::optional<FrameStamp>> read_frame_row(const CsvReader& reader, const CsvRow& row) {
  const Result<std::int64_t> index = reader.integer(row, 0);
  if (!index) return tl::unexpected(index.error());
  const Result<std::optional<SensorDuration>> time = reader.time(row, 1, TimeUnit::seconds);
  if (!time) return tl::unexpected(time.error());
  if (!*time) return std::optional<FrameStamp>();
  FrameStamp stamp{*index, SensorTime(**time), std::nullopt};
  if (row.fields[2].empty()) return std::optional(stamp);
  const Result<std::optional<SensorDuration>> exposure = reader.time(row, 2, TimeUnit::seconds);
  if (!exposure) return tl::unexpected(exposure.error());
  if (*exposure && **exposure >= SensorDuration{}) stamp.exposure = **exposure;
  return std::optional(stamp);
}

/// For each sample the length of the longest rising run that begins with it (patience sorting from
/// the end, O(n log n)).
template <typename Sample>
std::vector<std::size_t> longest_rises(const std::vector<Sample>& samples) {
  std::vector<SensorTime>
      heads;  // heads[k]: the latest stamp that a run of k + 1 samples begins with
  std::vector<std::size_t> lengths(samples.size());
  for (std::size_t i = samples.size(); i-- > 0;) {
    const auto place =
        std::lower_bound(heads.begin(), heads.end(), samples[i].time, std::greater<>());
    lengths[i] = static_cast<std::size_t>(place - heads.begin()) + 1;
    if (place == heads.end()) {
      heads.push_back(samples[i].time);
    } else {
      *place = samples[i].time;
    }
  }
  return lengths;
}

/// Marks a longest rising run; of several the one that keeps earlier samples, so that of two stamps
/// of which one has to go it is the one that stepped back.
template <typename Sample>
std::vector<bool> mark_longest_rise(const std::vector<Sample>& samples) {
  const std::vector<std::size_t> lengths = longest_rises(samples);
  std::vector<bool> marked(samples.size(), false);
  std::size_t wanted = lengths.empty() ? 0 : *std::max_element(lengths.begin(), lengths.end());
  std::optional<SensorTime> last;
  for (std::size_t i = 0; i < samples.size() && wanted > 0; ++i) {
    if (lengths[i] != wanted || (last && samples[i].time <= *last)) continue;
    marked[i] = true;
    last = samples[i].time;
    --wanted;
  }
  return marked;
}

template <typename Sample>
std::string describe_fallen_stamp(const StampedLog<Sample>& log, std::size_t i) {
  if (i + 1 < log.samples.size() && log.samples[i].time >= log.samples[i + 1].time) {
    return fmt::format("line {} is not before line {}", log.lines[i], log.lines[i + 1]);
  }
  const SensorDuration step =
      i > 0 ? log.samples[i].time - log.samples[i - 1].time : SensorDuration{};
  if (step == SensorDuration{}) return fmt::format("line {} repeats a stamp", log.lines[i]);
  if (step < SensorDuration{}) {
    return fmt::format("line {} steps back by {:.6f} s", log.lines[i], -to_seconds(step));
  }
  return fmt::format("line {} is out of order", log.lines[i]);
}

/// What stamps with this median step seem to be counted in, if not in seconds.
std::optional<std::string_view> guess_unit(double median_step_s, PlausibleStep plausible) {
  struct Unit {
    double per_second;
    std::string_view name;
  };
  constexpr std::array<Unit, 3> kUnits{
      {{1e3, "milliseconds"}, {1e6, "microseconds"}, {1e9, "nanoseconds"}}};
  for (const Unit& unit : kUnits) {
    const double step_s = median_step_s / unit.per_second;
    if (step_s >= plausible.shortest_s && step_s <= plausible.longest_s) return unit.name;
  }
  return std::nullopt;
}

}  // namespace

template <typename Sample>
Result<StampedLog<Sample>> read_vectors(CsvReader& reader, const VectorLogFormat& format,
                                        std::vector<std::string>& warnings) {
  StampedLog<Sample> log{reader.path(), {}, {}, 0};
  LineTally not_finite;
  while (true) {
    const Result<std::optional<CsvRow>> row = reader.next();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    const Result<std::optional<VectorRow>> vector = read_vector_row(reader, **row, format);
    if (!vector) return tl::unexpected(vector.error());
    if (*vector) {
      log.samples.push_back({(*vector)->time, (*vector)->value});
      log.lines.push_back((*row)->line);
    } else {
      not_finite.add((*row)->line);
    }
  }
  report_not_finite(log.file, not_finite, warnings);
  report_cut_end(log.file, reader, warnings);
  log.rows_not_finite = not_finite.count;
  return log;
}

Result<GyroLog> read_gyro_csv(const std::filesystem::path& path,
                              std::vector<std::string>& warnings) {
  Result<CsvReader> reader = CsvReader::open(path, {{"t_s", "x", "y", "z"}, {}});
  if (!reader) return tl::unexpected(reader.error());
  return read_vectors<GyroSample>(*reader, {}, warnings);
}

Result<AccelLog> read_accel_csv(const std::filesystem::path& path, double to_specific_force_m_s2,
                                std::vector<std::string>& warnings) {
  Result<CsvReader> reader = CsvReader::open(path, {{"t_s", "x", "y", "z"}, {}});
  if (!reader) return tl::unexpected(reader.error());
  return read_vectors<AccelSample>(*reader, {TimeUnit::seconds, to_specific_force_m_s2}, warnings);
}

Result<FrameLog> read_frames_csv(const std::filesystem::path& path,
                                 std::vector<std::string>& warnings) {
  Result<CsvReader> reader = CsvReader::open(path, {{"index", "t_s"}, {"exposure_s"}});
  if (!reader) return tl::unexpected(reader.error());
  FrameLog log{path, {}, {}, 0};
  LineTally not_finite;
  while (true) {
    const Result<std::optional<CsvRow>> row = reader->next();
    if (!row) return tl::unexpected(row.error());
    if (!*row) break;
    const Result<std::optional<FrameStamp>> stamp = read_frame_row(*reader, **row);
    if (!stamp) return tl::unexpected(stamp.error());
    if (*stamp) {
      log.samples.push_back(**stamp);
      log.lines.push_back((*row)->line);
    } else {
      not_finite.add((*row)->line);
    }
  }
  report_not_finite(path, not_finite, warnings);
  report_cut_end(path, *reader, warnings);
  log.rows_not_finite = not_finite.count;
  return log;
}

template <typename Sample>
void keep_rising_stamps(StampedLog<Sample>& log, std::vector<std::string>& warnings) {
  const std::vector<bool> rising = mark_longest_rise(log.samples);
  const auto fallen = static_cast<std::size_t>(std::count(rising.begin(), rising.end(), false));
  if (fallen == 0) return;
  const auto first =
      static_cast<std::size_t>(std::find(rising.begin(), rising.end(), false) - rising.begin());
  warnings.push_back(fmt::format("{}: {} row{} left out because stamps do not rise: {}{}",
                                 name_of(log.file), fallen, plural(fallen),
                                 describe_fallen_stamp(log, first), fallen > 1 ? ", ..." : ""));
  StampedLog<Sample> kept{log.file, {}, {}, log.rows_not_finite};
  for (std::size_t i = 0; i < rising.size(); ++i) {
    if (!rising[i]) continue;
    kept.samples.push_back(log.samples[i]);
    kept.lines.push_back(log.lines[i]);
  }
  log = std::move(kept);
}

template <typename Sample>
Result<void> check_has_samples(const StampedLog<Sample>& log) {
  if (!log.samples.empty()) return {};
  if (log.rows_not_finite == 0) {
    return bad_input(fmt::format(
        "{}: no rows after the header; leave the file out if there are none", log.file.string()));
  }
  return bad_input(
      fmt::format("{}: all {} rows have values that are not finite; numbers are expected",
                  log.file.string(), log.rows_not_finite));
}

template <typename Sample>
Result<void> check_stamps_are_seconds(const StampedLog<Sample>& log, PlausibleStep plausible) {
  if (log.samples.size() < 2) return {};
  const double step_s = to_seconds(median_step(log.samples));
  if (step_s >= plausible.shortest_s && step_s <= plausible.longest_s) return {};
  const std::optional<std::string_view> unit = guess_unit(step_s, plausible);
  return bad_input(fmt::format("{}: t_s must be in seconds, but its steps of {:g} {}",
                               log.file.string(), step_s,
                               unit ? fmt::format("look like {}", *unit)
                                    : fmt::format("are not between {:g} and {:g}",
                                                  plausible.shortest_s, plausible.longest_s)));
}

template <typename Sample>
void report_gaps(const StampedLog<Sample>& log, double longest_in_medians,
                 std::vector<std::string>& warnings) {
  const double limit_s = longest_in_medians * to_seconds(median_step(log.samples));
  std::size_t gap_count = 0;
  std::size_t longest_at = 0;
  SensorDuration longest{};
  for (std::size_t i = 1; i < log.samples.size(); ++i) {
    const SensorDuration step = log.samples[i].time - log.samples[i - 1].time;
    if (to_seconds(step) <= limit_s) continue;
    ++gap_count;
    if (step <= longest) continue;
    longest = step;
    longest_at = i - 1;
  }
  if (gap_count == 0) return;
  warnings.push_back(fmt::format(
      "{}: {} gap{}, {} {:.3f} s after line {} (t = {:.3f} s)", name_of(log.file), gap_count,
      plural(gap_count), gap_count == 1 ? "of" : "the longest of", to_seconds(longest),
      log.lines[longest_at], seconds_since_epoch(log.samples[longest_at].time)));
}

template <typename Sample>
SensorDuration median_step(const std::vector<Sample>& samples) {
  if (samples.size() < 2) return {};
  std::vector<SensorDuration> steps;
  steps.reserve(samples.size() - 1);
  for (std::size_t i = 1; i < samples.size(); ++i) {
    steps.push_back(samples[i].time - samples[i - 1].time);
  }
  const auto middle = steps.begin() + std::ssize(steps) / 2;
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

template Result<GyroLog> read_vectors(CsvReader&, const VectorLogFormat&,
                                      std::vector<std::string>&);
template Result<AccelLog> read_vectors(CsvReader&, const VectorLogFormat&,
                                       std::vector<std::string>&);

template void keep_rising_stamps(StampedLog<GyroSample>&, std::vector<std::string>&);
template Result<void> check_has_samples(const StampedLog<GyroSample>&);
template Result<void> check_stamps_are_seconds(const StampedLog<GyroSample>&, PlausibleStep);
template void report_gaps(const StampedLog<GyroSample>&, double, std::vector<std::string>&);
template SensorDuration median_step(const std::vector<GyroSample>&);

template void keep_rising_stamps(StampedLog<AccelSample>&, std::vector<std::string>&);
template Result<void> check_has_samples(const StampedLog<AccelSample>&);
template Result<void> check_stamps_are_seconds(const StampedLog<AccelSample>&, PlausibleStep);
template void report_gaps(const StampedLog<AccelSample>&, double, std::vector<std::string>&);
template SensorDuration median_step(const std::vector<AccelSample>&);

template void keep_rising_stamps(StampedLog<FrameStamp>&, std::vector<std::string>&);
template Result<void> check_has_samples(const StampedLog<FrameStamp>&);
template Result<void> check_stamps_are_seconds(const StampedLog<FrameStamp>&, PlausibleStep);
template void report_gaps(const StampedLog<FrameStamp>&, double, std::vector<std::string>&);
template SensorDuration median_step(const std::vector<FrameStamp>&);

}  // namespace gimbal

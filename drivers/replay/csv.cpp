#include "drivers/replay/csv.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <system_error>
#include <utility>

#include "drivers/replay/in_quotes.hpp"

namespace gimbal {

namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// A recording that was stopped by force ends in the middle of a line. A comma may end one: the
/// last column may be empty.
bool ends_inside_number(std::string_view line) {
  return std::string_view("+-.eE").find(line.back()) != std::string_view::npos;
}

/// Opens what can be read to its end: a device or a pipe could keep us waiting for ever.
Result<std::ifstream> open_regular_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    return bad_input(fmt::format("{}: no such file", path.string()));
  }
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return bad_input(fmt::format("{}: not a regular file", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return bad_input(fmt::format("{}: cannot be opened; may you read it?", path.string()));
  return file;
}

}  // namespace

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, value);
  if (end != text_end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::numeric_limits<double>::infinity();
  return value;
}

CsvReader::CsvReader(std::filesystem::path path, std::ifstream file, Columns columns,
                     char separator)
    : path_(std::move(path)),
      file_(std::move(file)),
      columns_(std::move(columns)),
      separator_(separator) {}

Result<CsvReader> CsvReader::open(const std::filesystem::path& path, Columns columns) {
  Result<std::ifstream> file = open_regular_file(path);
  if (!file) return tl::unexpected(file.error());
  CsvReader reader(path, std::move(*file), std::move(columns), ',');
  if (Result<void> header = reader.read_header(); !header) return tl::unexpected(header.error());
  return reader;
}

Result<CsvReader> CsvReader::open_headerless(const std::filesystem::path& path,
                                             const std::vector<PlacedColumn>& columns,
                                             char separator) {
  Result<std::ifstream> file = open_regular_file(path);
  if (!file) return tl::unexpected(file.error());
  CsvReader reader(path, std::move(*file), {}, separator);
  for (const PlacedColumn& column : columns) {
    auto& names =
        column.presence == Presence::required ? reader.columns_.required : reader.columns_.optional;
    names.push_back(column.name);
    reader.positions_.emplace_back(column.place);
  }
  return reader;
}

Result<void> CsvReader::read_header() {
  const std::string wanted = fmt::format("{}", fmt::join(columns_.required, ","));
  const Result<bool> found = read_line();
  if (!found) return tl::unexpected(found.error());
  if (!*found) {
    return bad_input(
        fmt::format("{}: empty; a header line {} and rows are expected", path_.string(), wanted));
  }
  const std::vector<std::string_view> names = split();
  const auto locate = [&](const std::string& name) -> std::optional<std::size_t> {
    const auto found_name = std::find(names.begin(), names.end(), name);
    if (found_name == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found_name - names.begin());
  };
  for (const std::string& name : columns_.required) {
    positions_.push_back(locate(name));
    if (!positions_.back()) {
      return bad_input(fmt::format("{}, line {}: no column {} in the header {}; {} is expected",
                                   path_.string(), line_number_, name, in_quotes(line_), wanted));
    }
  }
  for (const std::string& name : columns_.optional) positions_.push_back(locate(name));
  return {};
}

/// The next line with content goes to `line_`; false at the end of the file.
Result<bool> CsvReader::read_line() {
  while (file_.getline(buffer_.data(), std::ssize(buffer_)) || file_.gcount() > 0) {
    ++line_number_;
    if (file_.fail()) {
      return bad_input(fmt::format("{}, line {}: longer than {} bytes; is this a table of numbers?",
                                   path_.string(), line_number_, kLongestLine - 1));
    }
    std::string_view line(buffer_.data(), static_cast<std::size_t>(file_.gcount()));
    if (!file_.eof()) line.remove_suffix(1);  // getline counts the end of line that it dropped
    if (line_number_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    line_ = trimmed(line);
    if (!line_.empty() && line_.front() != '#') return true;
  }
  if (file_.bad()) return failed(fmt::format("{}: cannot be read further", path_.string()));
  return false;
}

std::vector<std::string_view> CsvReader::split() const {
  std::vector<std::string_view> fields;
  std::string_view rest = line_;
  const std::string_view separators =
      separator_ == ' ' ? std::string_view(" \t") : std::string_view(&separator_, 1);
  while (true) {
    const std::size_t end = rest.find_first_of(separators);
    fields.push_back(trimmed(rest.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    rest.remove_prefix(end + 1);
    if (separator_ == ' ') rest = trimmed(rest);
  }
}

Result<std::optional<CsvRow>> CsvReader::next() {
  const Result<bool> found = read_line();
  if (!found) return tl::unexpected(found.error());
  if (!*found) return std::optional<CsvRow>();
  ended_early_ = file_.eof() && ends_inside_number(line_);
  if (ended_early_) return std::optional<CsvRow>();
  const std::vector<std::string_view> all = split();
  CsvRow row{line_number_, {}};
  for (std::size_t column = 0; column < positions_.size(); ++column) {
    const std::optional<std::size_t> position = positions_[column];
    const bool is_required = column < columns_.required.size();
    const bool is_there = position && *position < all.size();
    ended_early_ = file_.eof() && is_required && (!is_there || all[*position].empty());
    if (ended_early_) return std::optional<CsvRow>();
    if (is_there) {
      row.fields.push_back(all[*position]);
    } else if (is_required) {
      return bad_input(fmt::format("{}, line {}: column {} is missing, found {}", path_.string(),
                                   line_number_, column_name(column), in_quotes(line_)));
    } else {
      row.fields.emplace_back();
    }
  }
  return std::optional<CsvRow>(std::move(row));
}

Result<double> CsvReader::number(const CsvRow& row, std::size_t column) const {
  if (const std::optional<double> value = parse_number(row.fields[column])) return *value;
  return error_at(row, column, "a number is expected");
}

Result<std::optional<SensorDuration>> CsvReader::time(const CsvRow& row, std::size_t column,
                                                      TimeUnit unit) const {
  const auto duration = parse_time(row.fields[column], unit);
  if (duration) return std::optional(*duration);
  switch (duration.error()) {
    case TimeTextFault::not_finite:
      return std::optional<SensorDuration>();
    case TimeTextFault::out_of_range:
      return error_at(row, column,
                      unit == TimeUnit::seconds
                          ? "too large for seconds; is this in milli-, micro- or nanoseconds?"
                          : "too large for a time");
    case TimeTextFault::not_a_number:
      break;
  }
  return error_at(row, column, "a time is expected");
}

Result<std::int64_t> CsvReader::integer(const CsvRow& row, std::size_t column) const {
  const std::string_view text = row.fields[column];
  std::int64_t value = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, value);
  if (end != text_end || error != std::errc()) {
    return error_at(row, column, "a whole number is expected");
  }
  return value;
}

tl::unexpected<Error> CsvReader::error_at(const CsvRow& row, std::size_t column,
                                          std::string_view expected) const {
  return bad_input(fmt::format("{}, line {}, column {}: found {}, {}", path_.string(), row.line,
                               column_name(column), in_quotes(row.fields[column]), expected));
}

const std::string& CsvReader::column_name(std::size_t column) const {
  return column < columns_.required.size() ? columns_.required[column]
                                           : columns_.optional[column - columns_.required.size()];
}

}  // namespace gimbal

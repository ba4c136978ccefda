#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/replay/decimal_time.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A decimal number, all of `text`; "nan" and "inf" are numbers here, and so are infinite those
/// that a double cannot hold.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

/// One line of numbers. Fields are in the order in which the columns were asked for, an optional
/// column that the file lacks being empty; they live until the next row is read.
struct CsvRow {
  std::int64_t line = 0;  ///< as editors count, from 1
  std::vector<std::string_view> fields;
};

/// Reads numbers in columns. Lines that are empty or begin with # are passed over; CR LF, a byte
/// order mark and a missing end of the last line are taken as they come.
class CsvReader {
 public:
  struct Columns {
    std::vector<std::string> required;
    std::vector<std::string> optional;
  };

  /// Columns are found by the names in the first line, in any order; others are passed over.
  [[nodiscard]] static Result<CsvReader> open(const std::filesystem::path& path, Columns columns);

  enum class Presence : std::uint8_t { required, optional };

  struct PlacedColumn {
    std::string name;       ///< for messages
    std::size_t place = 0;  ///< in the line, from 0
    Presence presence = Presence::required;
  };

  /// For logs without a header; optional columns come last. A space as separator stands for any run
  /// of spaces and tabs.
  [[nodiscard]] static Result<CsvReader> open_headerless(const std::filesystem::path& path,
                                                         const std::vector<PlacedColumn>& columns,
                                                         char separator);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// The next row; nothing at the end.
  [[nodiscard]] Result<std::optional<CsvRow>> next();

  /// A field of the row as a number; "nan" and "inf" are numbers here.
  [[nodiscard]] Result<double> number(const CsvRow& row, std::size_t column) const;

  /// A field of the row as a time; nothing if it is not finite.
  [[nodiscard]] Result<std::optional<SensorDuration>> time(const CsvRow& row, std::size_t column,
                                                           TimeUnit unit) const;

  /// A field of the row as a whole number.
  [[nodiscard]] Result<std::int64_t> integer(const CsvRow& row, std::size_t column) const;

  /// An error about a field of the row: file, line, column, what was found, what is expected.
  [[nodiscard]] tl::unexpected<Error> error_at(const CsvRow& row, std::size_t column,
                                               std::string_view expected) const;

  /// True once the last line was found to be cut off, and passed over.
  [[nodiscard]] bool ended_early() const { return ended_early_; }

 private:
  static constexpr std::size_t kLongestLine = 4096;

  CsvReader(std::filesystem::path path, std::ifstream file, Columns columns, char separator);

  Result<bool> read_line();
  Result<void> read_header();
  [[nodiscard]] std::vector<std::string_view> split() const;
  [[nodiscard]] const std::string& column_name(std::size_t column) const;

  std::filesystem::path path_;
  std::ifstream file_;
  Columns columns_;
  char separator_;
  std::vector<std::optional<std::size_t>> positions_;  ///< where in a line each column is
  std::array<char, kLongestLine> buffer_{};
  std::string_view line_;
  std::int64_t line_number_ = 0;
  bool ended_early_ = false;
};

}  // namespace gimbal

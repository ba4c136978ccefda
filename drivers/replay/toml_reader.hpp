#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A word of a file and the value that it stands for.
template <typename T>
struct NamedValue {
  std::string_view name;
  T value;
};

/// A table of a TOML file, read key by key. Each reader answers nothing if the key is not there, or
/// not as it should be; the first such fault is kept in `error`, with file, line, key, what was
/// found and what is allowed.
class TomlTable {
 public:
  /// Refuses what is not UTF-8, not TOML, or larger than a megabyte.
  [[nodiscard]] static Result<TomlTable> load(const std::filesystem::path& path);

  /// As a file of the name `origin` with this text would be read.
  [[nodiscard]] static Result<TomlTable> parse(const std::string& text, const std::string& origin);

  TomlTable(TomlTable&&) noexcept;
  TomlTable& operator=(TomlTable&&) noexcept;
  ~TomlTable();

  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] bool is_text(std::string_view key) const;
  [[nodiscard]] std::optional<std::string> text(std::string_view key);
  /// A string, or one of TOML's own dates, as text.
  [[nodiscard]] std::optional<std::string> date(std::string_view key);
  [[nodiscard]] std::optional<double> number(std::string_view key);
  [[nodiscard]] std::optional<bool> boolean(std::string_view key);
  [[nodiscard]] std::optional<std::vector<std::string>> texts(std::string_view key);
  [[nodiscard]] std::optional<int> integer(std::string_view key, int least, int most);
  /// true and false count as 1 and 0.
  [[nodiscard]] std::optional<std::int64_t> whole_number(std::string_view key);
  [[nodiscard]] std::optional<std::vector<double>> numbers(std::string_view key);
  /// Three rows of three numbers.
  [[nodiscard]] std::optional<Eigen::Matrix3d> matrix3(std::string_view key);
  [[nodiscard]] std::optional<TomlTable> table(std::string_view key);
  /// Tables [[key]], in their order.
  [[nodiscard]] std::optional<std::vector<TomlTable>> tables(std::string_view key);

  template <typename T>
  [[nodiscard]] std::optional<T> choice(std::string_view key,
                                        std::span<const NamedValue<T>> allowed) {
    const std::optional<std::string> word = text(key);
    if (!word) return std::nullopt;
    std::vector<std::string_view> names;
    for (const NamedValue<T>& candidate : allowed) {
      if (candidate.name == *word) return candidate.value;
      names.push_back(candidate.name);
    }
    refuse_word(key, *word, names);
    return std::nullopt;
  }

  [[nodiscard]] std::vector<std::string> keys() const;

  /// Keeps a fault of a key's value that the caller found.
  void refuse(std::string_view key, std::string_view complaint);

  /// Keeps a fault of a table inside this one.
  void refuse(const Error& error);

  [[nodiscard]] const std::optional<Error>& error() const;

  /// A line for each key that was never asked for, with the nearest one that was.
  [[nodiscard]] std::vector<std::string> unknown_keys() const;

 private:
  struct State;
  explicit TomlTable(std::unique_ptr<State> state);

  void refuse_word(std::string_view key, std::string_view word,
                   const std::vector<std::string_view>& allowed);

  std::unique_ptr<State> state_;
};

}  // namespace gimbal

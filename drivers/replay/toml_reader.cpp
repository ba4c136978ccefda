#include "drivers/replay/toml_reader.hpp"

#include <fmt/core.h>
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <sstream>
#include <utility>

#include "drivers/replay/in_quotes.hpp"

namespace gimbal {

namespace {

/// A node for messages, on one line.
std::string as_written(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return in_quotes(*text);
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  std::istringstream words(out.str());
  std::string line;
  for (std::string word; words >> word;) line += line.empty() ? word : " " + word;
  return in_quotes(line);
}

std::optional<std::vector<double>> as_numbers(const toml::node& node) {
  const toml::array* const array = node.as_array();
  if (array == nullptr) return std::nullopt;
  std::vector<double> values;
  for (const toml::node& element : *array) {
    const std::optional<double> value = element.value<double>();
    if (!element.is_number() || !value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

/// Levenshtein's distance: letters to insert, delete or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

Result<std::string> read_text(const std::filesystem::path& path) {
  constexpr std::uintmax_t kLargest = 1 << 20;
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return bad_input(fmt::format("{}: no such file", path.string()));
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error || size > kLargest) {
    return bad_input(fmt::format("{}: larger than a session.toml can be", path.string()));
  }
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file) return bad_input(fmt::format("{}: cannot be read; may you?", path.string()));
  return text;
}

}  // namespace

struct TomlTable::State {
  std::string file;
  std::string prefix;  ///< "camera." for keys of [camera]
  std::shared_ptr<const toml::table> document;
  const toml::table* table = nullptr;  ///< in the document: a copy would forget its lines
  std::vector<std::string> asked_for;
  std::optional<Error> error;

  /// For a table in this one.
  [[nodiscard]] std::unique_ptr<State> inside(const toml::table& inner,
                                              std::string_view key) const {
    auto state = std::make_unique<State>();
    state->file = file;
    state->prefix = fmt::format("{}{}.", prefix, key);
    state->document = document;
    state->table = &inner;
    return state;
  }

  const toml::node* find(std::string_view key) {
    asked_for.emplace_back(key);
    return table->get(key);
  }

  void keep_fault(const toml::node& node, std::string_view key, std::string_view complaint) {
    if (error) return;
    error = Error{Error::Kind::bad_input,
                  fmt::format("{}, line {}: {}{} {}", file, node.source().begin.line, prefix, key,
                              complaint)};
  }

  void expect(const toml::node& node, std::string_view key, std::string_view expected) {
    keep_fault(node, key, fmt::format("is {}; {} is expected", as_written(node), expected));
  }
};

TomlTable::TomlTable(std::unique_ptr<State> state) : state_(std::move(state)) {}
TomlTable::TomlTable(TomlTable&&) noexcept = default;
TomlTable& TomlTable::operator=(TomlTable&&) noexcept = default;
TomlTable::~TomlTable() = default;

Result<TomlTable> TomlTable::load(const std::filesystem::path& path) {
  const Result<std::string> text = read_text(path);
  if (!text) return tl::unexpected(text.error());
  return parse(*text, path.string());
}

Result<TomlTable> TomlTable::parse(const std::string& text, const std::string& origin) {
  auto state = std::make_unique<State>();
  state->file = origin;
  try {
    state->document = std::make_shared<const toml::table>(toml::parse(text));
    state->table = state->document.get();
  } catch (const toml::parse_error& error) {
    std::string reason(error.description());
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    return bad_input(fmt::format("{}, line {}: {}", origin, error.source().begin.line, reason));
  }
  return TomlTable(std::move(state));
}

bool TomlTable::has(std::string_view key) const {
  return state_->table->contains(key);
}

bool TomlTable::is_text(std::string_view key) const {
  const toml::node* const node = state_->table->get(key);
  return node != nullptr && node->is_string();
}

std::optional<std::string> TomlTable::text(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  std::optional<std::string> value = node->value_exact<std::string>();
  if (!value) state_->expect(*node, key, "text in quotes");
  return value;
}

std::optional<std::string> TomlTable::date(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr || node->is_string()) return text(key);
  if (node->is_date_time() || node->is_date()) {
    std::ostringstream out;
    node->visit([&](const auto& value) { out << value; });
    return std::move(out).str();
  }
  state_->expect(*node, key, "a date (RFC 3339)");
  return std::nullopt;
}

std::optional<bool> TomlTable::boolean(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<bool> value = node->value_exact<bool>();
  if (!value) state_->expect(*node, key, "true or false");
  return value;
}

std::optional<std::vector<std::string>> TomlTable::texts(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* const array = node->as_array();
  std::vector<std::string> values;
  for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
    if (const auto value = (*array)[i].value_exact<std::string>()) values.push_back(*value);
  }
  if (array == nullptr || values.size() != array->size()) {
    state_->expect(*node, key, "a list of texts in quotes");
    return std::nullopt;
  }
  return values;
}

std::optional<double> TomlTable::number(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<double> value = node->value<double>();
  if (node->is_number() && value && std::isfinite(*value)) return value;
  state_->expect(*node, key, "a finite number");
  return std::nullopt;
}

std::optional<int> TomlTable::integer(std::string_view key, int least, int most) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  const std::optional<std::int64_t> value = node->value_exact<std::int64_t>();
  if (value && *value >= least && *value <= most) return static_cast<int>(*value);
  state_->expect(*node, key, fmt::format("a whole number from {} to {}", least, most));
  return std::nullopt;
}

std::optional<std::int64_t> TomlTable::whole_number(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  if (const auto truth = node->value_exact<bool>()) return *truth ? 1 : 0;
  const std::optional<std::int64_t> value = node->value_exact<std::int64_t>();
  if (!value) state_->expect(*node, key, "a whole number");
  return value;
}

std::optional<std::vector<double>> TomlTable::numbers(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  std::optional<std::vector<double>> values = as_numbers(*node);
  const auto is_finite = [](double value) { return std::isfinite(value); };
  if (values && std::all_of(values->begin(), values->end(), is_finite)) return values;
  state_->expect(*node, key, "a list of finite numbers");
  return std::nullopt;
}

std::optional<Eigen::Matrix3d> TomlTable::matrix3(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  constexpr std::string_view kExpected = "three rows of three finite numbers";
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  const toml::array* const rows = node->as_array();
  bool good = rows != nullptr && rows->size() == 3;
  for (std::size_t r = 0; good && r < 3; ++r) {
    const std::optional<std::vector<double>> row = as_numbers(*rows->get(r));
    good = row && row->size() == 3;
    if (good) matrix.row(static_cast<Eigen::Index>(r)) = Eigen::RowVector3d(row->data());
  }
  if (good && matrix.allFinite()) return matrix;
  state_->expect(*node, key, kExpected);
  return std::nullopt;
}

std::optional<TomlTable> TomlTable::table(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  const toml::table* const inner = node->as_table();
  if (inner == nullptr) {
    state_->expect(*node, key, fmt::format("a table [{}]", key));
    return std::nullopt;
  }
  return TomlTable(state_->inside(*inner, key));
}

std::optional<std::vector<TomlTable>> TomlTable::tables(std::string_view key) {
  const toml::node* const node = state_->find(key);
  if (node == nullptr) return std::nullopt;
  const toml::array* const array = node->as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
    state_->expect(*node, key, fmt::format("tables [[{}]]", key));
    return std::nullopt;
  }
  std::vector<TomlTable> tables;
  for (const toml::node& element : *array) {
    tables.push_back(TomlTable(state_->inside(*element.as_table(), key)));
  }
  return tables;
}

void TomlTable::refuse(std::string_view key, std::string_view complaint) {
  const toml::node* const node = state_->table->get(key);
  state_->keep_fault(node != nullptr ? *node : *state_->table, key, complaint);
}

void TomlTable::refuse(const Error& error) {
  if (!state_->error) state_->error = error;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> keys;
  keys.reserve(state_->table->size());
  for (const auto& [key, node] : *state_->table) keys.emplace_back(key.str());
  return keys;
}

void TomlTable::refuse_word(std::string_view key, std::string_view word,
                            const std::vector<std::string_view>& allowed) {
  refuse(key,
         fmt::format("is {}; allowed are \"{}\"", in_quotes(word), fmt::join(allowed, "\", \"")));
}

const std::optional<Error>& TomlTable::error() const {
  return state_->error;
}

std::vector<std::string> TomlTable::unknown_keys() const {
  constexpr std::size_t kNear = 3;
  std::vector<std::string> warnings;
  for (const auto& [key, node] : *state_->table) {
    const std::string_view name = key.str();
    const auto distance = [&](const std::string& known) { return edit_distance(name, known); };
    const auto& known = state_->asked_for;
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const auto nearest =
        std::min_element(known.begin(), known.end(),
                         [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    const bool is_near = nearest != known.end() && distance(*nearest) <= kNear;
    warnings.push_back(fmt::format(
        "{}, line {}: {}{} is not known{}", std::filesystem::path(state_->file).filename().string(),
        key.source().begin.line, state_->prefix, in_quotes(name),
        is_near ? fmt::format("; is {}{} meant?", state_->prefix, *nearest) : ""));
  }
  return warnings;
}

}  // namespace gimbal

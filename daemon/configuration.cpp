#include "daemon/configuration.hpp"

#include <array>
#include <optional>
#include <utility>

#include "drivers/replay/toml_reader.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kUsualLatencyFrames = 5;
constexpr int kLongestLatencyFrames = 300;
constexpr double kLargestZoom = 10;

enum class DriverKind : std::uint8_t { replay };
constexpr std::array<NamedValue<DriverKind>, 1> kDrivers{{{"replay", DriverKind::replay}}};

/// The value of a word among a map's.
template <typename T>
void read_choice(TomlTable& table, std::string_view key, const std::map<std::string, T>& names,
                 T& value) {
  std::vector<NamedValue<T>> allowed;
  allowed.reserve(names.size());
  for (const auto& [name, named] : names) allowed.push_back({name, named});
  if (const auto choice = table.choice<T>(key, allowed)) value = *choice;
}

void read_source(TomlTable& table) {
  static_cast<void>(table.choice<DriverKind>("driver", kDrivers));
}

void read_replay(TomlTable& table, ReplaySettings& replay) {
  if (auto session = table.text("session")) replay.session = *session;
  if (const auto repeat = table.boolean("repeat")) {
    replay.repeat = *repeat ? Repeat::forever : Repeat::once;
  }
}

void read_zoom(TomlTable& table, std::optional<double>& zoom) {
  if (!table.has("zoom")) return;
  if (table.is_text("zoom")) {
    if (table.text("zoom") != "auto") table.refuse("zoom", "must be \"auto\" or a ratio");
    zoom.reset();
  } else if (const auto ratio = table.number("zoom")) {
    if (!(*ratio >= 1 && *ratio <= kLargestZoom)) {
      table.refuse("zoom", "must be from 1 to 10, such as 1.15, or \"auto\"");
    }
    zoom = *ratio;
  }
}

void read_stabilization(TomlTable& table, StabilizationSettings& settings) {
  if (const auto amount = table.number("amount")) {
    if (!(*amount >= 0 && *amount <= 1)) table.refuse("amount", "must be from 0 to 1");
    settings.amount = *amount;
  }
  if (const auto frames = table.integer("latency_frames", 0, kLongestLatencyFrames)) {
    settings.latency = static_cast<std::size_t>(*frames);
  }
  read_zoom(table, settings.zoom);
  read_choice(table, "border", border_names(), settings.border);
  read_choice(table, "path", path_names(), settings.path);
  read_choice(table, "estimator", estimator_names(), settings.estimator);
  if (table.has("warper")) {
    WarperKind kind{};
    read_choice(table, "warper", warper_names(), kind);
    settings.warper = kind;
  }
}

/// Whether a table was read without a fault, and holds nothing that is not known.
Result<void> verdict(const TomlTable& table) {
  if (table.error()) return tl::unexpected(*table.error());
  if (const auto unknown = table.unknown_keys(); !unknown.empty()) {
    return bad_input(unknown.front());
  }
  return {};
}

template <typename Read>
Result<void> read_table(TomlTable& root, std::string_view name, const Read& read) {
  auto table = root.table(name);
  if (!table) return {};
  read(*table);
  return verdict(*table);
}

Result<void> read_file(const std::filesystem::path& file, Configuration& configuration) {
  auto root = TomlTable::load(file);
  if (!root) return tl::unexpected(root.error());
  if (auto outputs = root->texts("outputs")) configuration.outputs = std::move(*outputs);
  return read_table(*root, "camera", read_source)
      .and_then([&] { return read_table(*root, "imu", read_source); })
      .and_then([&] {
        return read_table(*root, "replay",
                          [&](TomlTable& table) { read_replay(table, configuration.replay); });
      })
      .and_then([&] {
        return read_table(*root, "stabilization", [&](TomlTable& table) {
          read_stabilization(table, configuration.stabilization);
        });
      })
      .and_then([&] { return verdict(*root); });
}

}  // namespace

Result<Configuration> load_configuration(std::span<const std::filesystem::path> files) {
  Configuration configuration;
  configuration.stabilization.latency = kUsualLatencyFrames;
  for (const std::filesystem::path& file : files) {
    if (auto read = read_file(file, configuration); !read) return tl::unexpected(read.error());
  }
  if (configuration.replay.session.empty()) {
    return bad_input(
        "no camera is configured: give --config FILE with [replay] session = \"FOLDER\"");
  }
  if (configuration.outputs.empty()) {
    return bad_input("no output is configured: give outputs = [\"-\"], a file or a pipeline text");
  }
  return configuration;
}

}  // namespace gimbal

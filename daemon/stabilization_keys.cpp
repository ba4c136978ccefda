#include "daemon/stabilization_keys.hpp"

#include <numbers>
#include <string>
#include <string_view>
#include <vector>

namespace gimbal {
namespace {

constexpr int kLongestLatencyFrames = 300;

/// The value of a word among a map's.
template <typename T>
void read_choice(TomlTable& table, std::string_view key, const std::map<std::string, T>& names,
                 T& value) {
  std::vector<NamedValue<T>> allowed;
  allowed.reserve(names.size());
  for (const auto& [name, named] : names) allowed.push_back({name, named});
  if (const auto choice = table.choice<T>(key, allowed)) value = *choice;
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

void read_zoom_limits(TomlTable& table, std::optional<ZoomLimits>& limits) {
  const auto numbers = table.numbers("zoom_limits");
  if (!numbers) return;
  const bool are_two = numbers->size() == 2;
  if (are_two) limits = {numbers->front(), numbers->back()};
  if (!are_two || !make_sense(*limits)) {
    table.refuse("zoom_limits", "must be two ratios from 1 to 10, such as [1.0, 1.4]");
  }
}

void read_zoom_speed(TomlTable& table, std::optional<double>& speed_per_s) {
  speed_per_s = table.has("zoom_speed_per_s") ? table.number("zoom_speed_per_s") : speed_per_s;
  if (speed_per_s && !(*speed_per_s > 0 && *speed_per_s <= kFastestZoom_per_s)) {
    table.refuse("zoom_speed_per_s", "must be above 0, and 10 at most");
  }
}

/// Only what this table says: choices that came before may wait for another zoom or border.
void refuse_idle_zoom_keys(TomlTable& table, const StabilizationSettings& settings) {
  for (const char* key : {"zoom_limits", "zoom_speed_per_s"}) {
    if (!table.has(key)) continue;
    if (settings.zoom) table.refuse(key, "is for zoom = \"auto\"");
    if (settings.border != Border::crop) table.refuse(key, "is for border = \"crop\"");
  }
  if (table.has("zoom_speed_per_s") && settings.path != PathKind::bounded) {
    table.refuse("zoom_speed_per_s", "is kept by path = \"bounded\" only");
  }
}

}  // namespace

void read_live_stabilization(TomlTable& table, StabilizationSettings& settings) {
  if (const auto amount = table.number("amount")) {
    if (!(*amount >= 0 && *amount <= 1)) table.refuse("amount", "must be from 0 to 1");
    settings.amount = *amount;
  }
  if (const auto frames = table.integer("latency_frames", 0, kLongestLatencyFrames)) {
    settings.latency = static_cast<std::size_t>(*frames);
  }
  read_zoom(table, settings.zoom);
  read_zoom_limits(table, settings.zoom_limits);
  read_zoom_speed(table, settings.zoom_speed_per_s);
  read_choice(table, "border", border_names(), settings.border);
  read_choice(table, "path", path_names(), settings.path);
  refuse_idle_zoom_keys(table, settings);
  read_choice(table, "horizon", horizon_names(), settings.lock.horizon);
  if (settings.lock.horizon != Horizon::off && settings.path != PathKind::bounded) {
    table.refuse("horizon", "is kept by path = \"bounded\" only");
  }
  if (const auto range_deg = table.number("horizon_range_deg")) {
    if (!(*range_deg >= 0 && *range_deg <= kWidestHorizonRange_deg)) {
      table.refuse("horizon_range_deg", "must be from 0 to 180");
    }
    settings.lock.most_roll_rad = *range_deg * std::numbers::pi / 180;
  }
}

void read_stabilization(TomlTable& table, StabilizationSettings& settings) {
  read_live_stabilization(table, settings);
  read_choice(table, "estimator", estimator_names(), settings.estimator);
  if (table.has("warper")) {
    WarperKind kind{};
    read_choice(table, "warper", warper_names(), kind);
    settings.warper = kind;
  }
  read_choice(table, "dma_buf", dma_buf_use_names(), settings.dma_bufs);
  read_choice(table, "interpolation", interpolation_names(), settings.interpolation);
  read_choice(table, "output_lens", output_lens_names(), settings.output_lens);
  if (const auto fov = table.number("output_fov_deg")) {
    if (!(*fov >= kNarrowestOutputFov_deg && *fov <= kWidestOutputFov_deg)) {
      table.refuse("output_fov_deg", "must be from 1 to 150");
    }
    settings.output_fov_deg = *fov;
  }
  if (settings.output_fov_deg && settings.output_lens == OutputLens::kept) {
    table.refuse("output_fov_deg", "is for output_lens = \"rectilinear\"");
  }
  if (const auto threads = table.integer("threads", 1, kMostDrawingThreads)) {
    settings.threads = static_cast<int>(*threads);
  }
}

Result<void> verdict(const TomlTable& table) {
  if (table.error()) return tl::unexpected(*table.error());
  if (const auto unknown = table.unknown_keys(); !unknown.empty()) {
    return bad_input(unknown.front());
  }
  return {};
}

}  // namespace gimbal

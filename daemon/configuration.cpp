#include "daemon/configuration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>

#include "daemon/control_keys.hpp"
#include "daemon/driver_keys.hpp"
#include "daemon/output_keys.hpp"
#include "daemon/stabilization_keys.hpp"
#include "drivers/gpio/gpio_lines.hpp"
#include "drivers/replay/calibration_keys.hpp"
#include "drivers/replay/toml_reader.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kUsualLatencyFrames = 5;

constexpr double kNarrowestView_deg = 1;
constexpr double kWidestView_deg = 170;  // of a lens that keeps straight lines straight

/// A recording is both, camera and IMU; its driver stands for neither.
template <typename Driver>
using DriverName = NamedValue<std::optional<Driver>>;
constexpr std::array<DriverName<CameraDriver>, 3> kCameraDrivers{
    {{"replay", std::nullopt},
     {"v4l2", CameraDriver::v4l2},
     {"libcamera", CameraDriver::libcamera}}};
constexpr std::array<DriverName<ImuDriver>, 5> kImuDrivers{
    {{"replay", std::nullopt},
     {"iio", ImuDriver::iio},
     {"i2c_mpu6500", ImuDriver::i2c_mpu6500},
     {"i2c_lsm6dso", ImuDriver::i2c_lsm6dso},
     {"i2c_icm42688", ImuDriver::i2c_icm42688}}};

/// What a file says of where things come from; a later file may say otherwise.
struct ChosenDrivers {
  std::optional<std::optional<CameraDriver>> camera;
  std::optional<std::optional<ImuDriver>> imu;
};

/// What is named in a file lies beside it, or comes with the program.
std::filesystem::path beside(const std::filesystem::path& file, const std::string& name) {
  std::filesystem::path near = file.parent_path() / name;
  if (std::filesystem::exists(near)) return near;
  const std::filesystem::path brought = std::filesystem::path(GIMBALD_DATA) / name;
  return std::filesystem::exists(brought) ? brought : near;
}

void read_camera(TomlTable& table, const std::filesystem::path& file, ChosenDrivers& drivers,
                 CalibrationSettings& calibration) {
  if (const auto driver = table.choice<std::optional<CameraDriver>>("driver", kCameraDrivers)) {
    drivers.camera = *driver;
  }
  if (const auto name = table.text("calibration")) {
    calibration.file = beside(file, *name);
    if (!std::filesystem::exists(calibration.file)) {
      table.refuse("calibration", "is not there: " + calibration.file.string());
    }
  }
  if (const auto view = table.number("horizontal_fov_deg")) {
    if (!(*view >= kNarrowestView_deg && *view <= kWidestView_deg)) {
      table.refuse("horizontal_fov_deg", "must be from 1 to 170");
    }
    calibration.horizontal_fov_deg = view;
  }
  if (const auto readout = read_readout(table)) calibration.readout = readout;
  if (const auto direction =
          table.choice<ReadoutDirection>("readout_direction", readout_direction_names())) {
    calibration.readout_direction = direction;
  }
  if (const auto offset = read_time_offset(table)) calibration.time_offset = offset;
  if (const auto stamp = table.choice<TimestampReference>("timestamp", timestamp_names())) {
    calibration.timestamp = stamp;
  }
}

void read_bias_memory(TomlTable& table, BiasMemorySettings& settings) {
  constexpr double kSecondsADay = 86400;
  constexpr double kMostDays = 10000;
  if (const auto file = table.text("bias_file")) settings.file = *file;
  if (const auto days = table.number("bias_kept_days")) {
    if (!(*days > 0 && *days <= kMostDays)) {
      table.refuse("bias_kept_days", "must be above 0, and 10000 at most");
    } else {
      settings.longest_age = std::chrono::seconds(std::lround(*days * kSecondsADay));
    }
  }
}

void read_imu(TomlTable& table, ChosenDrivers& drivers, Configuration& configuration) {
  CalibrationSettings& calibration = configuration.calibration;
  if (const auto driver = table.choice<std::optional<ImuDriver>>("driver", kImuDrivers)) {
    drivers.imu = *driver;
  }
  if (const auto R = read_rotation(table, "R_camera_imu")) calibration.R_camera_imu = R;
  if (const auto delay = read_imu_delay(table)) calibration.imu_delay = delay;
  read_bias_memory(table, configuration.bias_memory);
}

void read_sync(TomlTable& table, SyncSettings& settings) {
  if (const auto online = table.boolean("online")) settings.online = online;
  if (const auto share = table.number("cpu_share")) {
    if (!(*share > 0 && *share <= 1)) table.refuse("cpu_share", "must be above 0, and 1 at most");
    settings.cpu_share = *share;
  }
}

void read_replay(TomlTable& table, ReplaySettings& replay) {
  if (auto session = table.text("session")) replay.session = *session;
  if (const auto repeat = table.boolean("repeat")) {
    replay.repeat = *repeat ? Repeat::forever : Repeat::once;
  }
}

void read_recording(TomlTable& table, RecordingSettings& settings) {
  constexpr int kMostFree_mb = 1'000'000'000;
  if (const auto folder = table.text("folder")) settings.folder = *folder;
  if (auto encoder = table.text("encoder")) settings.encoder = *std::move(encoder);
  if (const auto least = table.integer("min_free_mb", 0, kMostFree_mb)) {
    settings.min_free_mb = static_cast<std::uintmax_t>(*least);
  }
}

/// "gpiochip0:17"
void read_line(TomlTable& table, std::string_view key, std::string& line) {
  const auto text = table.text(key);
  if (!text) return;
  if (const auto address = parse_gpio_address(*text); !address) {
    table.refuse(key, address.error().message);
  }
  line = *text;
}

void read_polarity(TomlTable& table, std::string_view key, GpioPolarity& polarity) {
  if (const auto is_low = table.boolean(key)) {
    polarity = *is_low ? GpioPolarity::active_low : GpioPolarity::active_high;
  }
}

void read_gpio(TomlTable& table, GpioSettings& settings) {
  read_line(table, "record_button", settings.record_button);
  read_polarity(table, "record_button_active_low", settings.record_button_polarity);
  read_line(table, "status_led", settings.status_led);
  read_polarity(table, "status_led_active_low", settings.status_led_polarity);
#ifndef GIMBALD_HAS_GPIO
  for (const char* const key : {"record_button", "status_led"}) {
    if (table.has(key))
      table.refuse(key, "cannot be used: this gimbald was built without libgpiod");
  }
#endif
}

template <typename Read>
Result<void> read_table(TomlTable& root, std::string_view name, const Read& read) {
  auto table = root.table(name);
  if (!table) return {};
  read(*table);
  return verdict(*table);
}

/// Those of a later file go instead of an earlier one's.
Result<void> read_outputs(TomlTable& root, std::vector<OutputSettings>& outputs) {
  if (root.has("outputs") || root.has("output")) outputs.clear();
  for (std::string& text : root.texts("outputs").value_or(std::vector<std::string>{})) {
    if (auto known = check_sink_text(text); !known) root.refuse("outputs", known.error().message);
    outputs.push_back(TextOutput{std::move(text)});
  }
  auto tables = root.tables("output");
  if (!tables) return {};
  for (TomlTable& table : *tables) {
    if (auto output = read_output(table)) outputs.push_back(*std::move(output));
    if (auto sound = verdict(table); !sound) return sound;
  }
  return {};
}

Result<void> read_file(const std::filesystem::path& file, Configuration& configuration,
                       ChosenDrivers& drivers) {
  auto root = TomlTable::load(file);
  if (!root) return tl::unexpected(root.error());
  if (auto read = read_outputs(*root, configuration.outputs); !read) return read;
  CalibrationSettings& calibration = configuration.calibration;
  const auto read = [&](std::string_view name, const auto& reader) {
    return [&root, name, reader] { return read_table(*root, name, reader); };
  };
  return read("camera", [&](TomlTable& t) { read_camera(t, file, drivers, calibration); })()
      .and_then(read("imu", [&](TomlTable& t) { read_imu(t, drivers, configuration); }))
      .and_then(read("replay", [&](TomlTable& t) { read_replay(t, configuration.replay); }))
      .and_then(read("v4l2", [&](TomlTable& t) { read_v4l2(t, configuration.camera.v4l2); }))
      .and_then(read("libcamera",
                     [&](TomlTable& t) { read_libcamera(t, configuration.camera.libcamera); }))
      .and_then(read("iio", [&](TomlTable& t) { read_iio(t, configuration.imu.iio); }))
      .and_then(read("i2c", [&](TomlTable& t) { read_i2c(t, configuration.imu); }))
      .and_then(read("stabilization",
                     [&](TomlTable& t) { read_stabilization(t, configuration.stabilization); }))
      .and_then(read("sync", [&](TomlTable& t) { read_sync(t, configuration.sync); }))
      .and_then(read("control", [&](TomlTable& t) { read_control(t, configuration.control); }))
      .and_then(
          read("recording", [&](TomlTable& t) { read_recording(t, configuration.recording); }))
      .and_then(read("gpio", [&](TomlTable& t) { read_gpio(t, configuration.gpio); }))
      .and_then([&] { return verdict(*root); });
}

/// Camera and IMU are two devices, or one recording.
Result<void> choose_source(const ChosenDrivers& drivers, Configuration& configuration) {
  const auto camera = drivers.camera.value_or(std::nullopt);
  const auto imu = drivers.imu.value_or(std::nullopt);
  const bool is_said = drivers.camera || drivers.imu || !configuration.replay.session.empty();
  if (!is_said) {
    return bad_input(
        "no camera is configured: give --config FILE with driver = \"v4l2\" under [camera] and "
        "driver = \"iio\" under [imu], or [replay] session = \"FOLDER\"");
  }
  if (camera.has_value() != imu.has_value()) {
    return bad_input(
        "camera.driver and imu.driver do not go together: either both are \"replay\", or both are "
        "devices");
  }
  if (!camera) {
    if (!configuration.replay.session.empty()) return {};
    return bad_input("nothing to replay: give session = \"FOLDER\" under [replay]");
  }
  configuration.source = SourceKind::devices;
  configuration.camera.driver = *camera;
  configuration.imu.driver = *imu;
  return {};
}

}  // namespace

Result<std::vector<std::filesystem::path>> usual_configuration_files() {
  const std::filesystem::path folder = GIMBALD_SYSCONF;
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "conf.d", error)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  const std::filesystem::path main_file = folder / "gimbald.toml";
  if (std::filesystem::exists(main_file)) files.insert(files.begin(), main_file);
  if (!files.empty()) return files;
  return bad_input(
      fmt::format("{}: no such file: write one (see {}/examples), or give --config FILE",
                  main_file.string(), GIMBALD_DATA));
}

std::string imu_name(const Configuration& configuration) {
  const ImuSettings& imu = configuration.imu;
  std::string name = "replay-" + configuration.replay.session.string();
  if (configuration.source == SourceKind::devices) {
    const auto* const driver = std::ranges::find_if(
        kImuDrivers, [&](const auto& known) { return known.value == imu.driver; });
    const bool is_iio = imu.driver == ImuDriver::iio;
    name = fmt::format("{}-{}", driver->name, is_iio ? imu.iio.device : to_string(imu.i2c.address));
  }
  const auto is_not_plain = [](char c) {
    const bool is_plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                          (c >= 'a' && c <= 'z') || c == '.' || c == '_';
    return !is_plain;
  };
  std::ranges::replace_if(name, is_not_plain, '-');
  return name;
}

Result<Configuration> load_configuration(std::span<const std::filesystem::path> files) {
  Configuration configuration;
  configuration.stabilization.latency = kUsualLatencyFrames;
  ChosenDrivers drivers;
  for (const std::filesystem::path& file : files) {
    if (auto read = read_file(file, configuration, drivers); !read) {
      return tl::unexpected(read.error());
    }
  }
  if (auto chosen = choose_source(drivers, configuration); !chosen) {
    return tl::unexpected(chosen.error());
  }
  if (configuration.outputs.empty()) {
    return bad_input(
        "no output is configured: give outputs = [\"-\"], a file or a pipeline text, or a table "
        "[[output]] with preset = \"rtsp\"");
  }
  return configuration;
}

}  // namespace gimbal

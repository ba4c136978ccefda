#include "daemon/driver_keys.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "drivers/replay/calibration_keys.hpp"

namespace gimbal {
namespace {

constexpr int kLargestSide_px = 16384;
constexpr double kFastestCamera_hz = 1000;
constexpr double kSlowestImu_hz = 10;
constexpr double kFastestImu_hz = 32000;
constexpr int kMostBuffers = 32;
constexpr int kMostSamples = 65536;
constexpr double kLongestSilence_s = 60;

constexpr std::array<NamedValue<StampSource>, 2> kStampSources{
    {{"device", StampSource::device}, {"arrival", StampSource::arrival}}};
constexpr std::array<NamedValue<ForeignClock>, 2> kForeignClocks{
    {{"map", ForeignClock::map}, {"refuse", ForeignClock::refuse}}};

constexpr std::array<NamedValue<SampleDelivery>, 2> kDeliveries{
    {{"fifo", SampleDelivery::fifo}, {"polling", SampleDelivery::polling}}};
constexpr int kLargestChipAddress = 0x77;

/// Within the two ends; nothing if the key is not there or is refused.
std::optional<double> read_within(TomlTable& table, std::string_view key, double least,
                                  double most) {
  const auto number = table.number(key);
  if (!number) return std::nullopt;
  if (!(*number >= least && *number <= most)) {
    table.refuse(key, fmt::format("is {}; {} to {} is allowed", *number, least, most));
    return std::nullopt;
  }
  return number;
}

void read_silence_limit(TomlTable& table, SensorDuration& limit) {
  if (const auto silence = read_duration(table, "silence_limit_s", 0.1, kLongestSilence_s)) {
    limit = *silence;
  }
}

void read_live_camera(TomlTable& table, LiveCameraSettings& settings) {
  const auto width = table.integer("width", 1, kLargestSide_px);
  const auto height = table.integer("height", 1, kLargestSide_px);
  if (width && height) settings.size = ImageSize{*width, *height};
  if (width && !height) table.refuse("width", "needs height beside it");
  if (height && !width) table.refuse("height", "needs width beside it");
  if (const auto fps = read_within(table, "fps", 0.1, kFastestCamera_hz)) settings.fps = fps;
  if (auto format = table.text("pixel_format")) settings.pixel_format = *format;
  read_silence_limit(table, settings.silence_limit);
}

void read_controls(TomlTable& table, std::map<std::string, std::int64_t>& controls) {
  auto values = table.table("controls");
  if (!values) return;
  for (const std::string& name : values->keys()) {
    if (const auto value = values->whole_number(name)) controls[name] = *value;
  }
  if (values->error()) table.refuse(*values->error());
}

}  // namespace

void read_v4l2(TomlTable& table, V4l2CameraSettings& settings) {
  if (auto device = table.text("device")) settings.device = *device;
  read_live_camera(table, settings);
  read_controls(table, settings.controls);
  if (const auto source = table.choice<StampSource>("stamp_source", kStampSources)) {
    settings.stamp_source = *source;
  }
  if (const auto buffers = table.integer("buffers", 2, kMostBuffers)) settings.buffers = *buffers;
}

void read_libcamera(TomlTable& table, LibcameraSettings& settings) {
  if (auto camera = table.text("camera")) settings.camera = *camera;
  read_live_camera(table, settings);
  if (auto controls = table.table("controls")) {
    for (const std::string& name : controls->keys()) {
      if (auto values = controls->numbers(name)) settings.controls[name] = std::move(*values);
    }
    if (controls->error()) table.refuse(*controls->error());
  }
}

void read_iio(TomlTable& table, IioImuSettings& settings) {
  if (auto device = table.text("device")) settings.device = *device;
  if (auto device = table.text("accel_device")) settings.accel_device = *device;
  if (const auto rate = read_within(table, "rate_hz", kSlowestImu_hz, kFastestImu_hz)) {
    settings.rate_hz = *rate;
  }
  if (auto trigger = table.text("trigger")) settings.trigger = *trigger;
  if (const auto length = table.integer("buffer_length", 2, kMostSamples)) {
    settings.buffer_length = static_cast<unsigned>(*length);
  }
  read_silence_limit(table, settings.silence_limit);
  if (const auto clock = table.choice<ForeignClock>("foreign_clock", kForeignClocks)) {
    settings.foreign_clock = *clock;
  }
}

namespace {

/// A chip's range is one of two.
template <typename Range>
void read_range(TomlTable& table, std::string_view key, std::pair<int, Range> small,
                std::pair<int, Range> large, Range& range) {
  const auto value = table.whole_number(key);
  if (!value) return;
  if (*value != small.first && *value != large.first) {
    table.refuse(key,
                 fmt::format("is {}; {} and {} are allowed", *value, small.first, large.first));
    return;
  }
  range = *value == small.first ? small.second : large.second;
}

}  // namespace

void read_i2c(TomlTable& table, ImuSettings& settings) {
  I2cImuSettings& i2c = settings.i2c;
  if (auto bus = table.text("bus")) i2c.address.bus = *bus;
  if (const auto chip = table.integer("address", 0x08, kLargestChipAddress)) {
    i2c.address.chip = static_cast<std::uint8_t>(*chip);
  }
  if (const auto rate = read_within(table, "rate_hz", kSlowestImu_hz, kFastestImu_hz)) {
    i2c.rate_hz = *rate;
  }
  read_range<GyroRange>(table, "gyro_range_deg_s", {1000, GyroRange::dps_1000},
                        {2000, GyroRange::dps_2000}, i2c.gyro_range);
  read_range<AccelRange>(table, "accel_range_g", {8, AccelRange::g_8}, {16, AccelRange::g_16},
                         i2c.accel_range);
  if (const auto delivery = table.choice<SampleDelivery>("delivery", kDeliveries)) {
    i2c.delivery = *delivery;
  }
  if (auto line = table.text("data_ready")) settings.data_ready = *line;
  read_silence_limit(table, i2c.silence_limit);
}

}  // namespace gimbal

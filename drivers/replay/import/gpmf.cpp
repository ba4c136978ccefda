#include "drivers/replay/import/gpmf.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gimbal {

namespace {

constexpr std::size_t kHeader = 8;
constexpr std::uint8_t kNested = 0;

/// Key, length, value: `count` samples of `sample_size` bytes, padded to four.
struct Item {
  FourCc key = 0;
  std::uint8_t type = 0;
  std::size_t sample_size = 0;
  std::size_t count = 0;
  ByteView data;
};

std::vector<Item> items_of(ByteView bytes) {
  std::vector<Item> items;
  std::size_t offset = 0;
  while (true) {
    const auto key = bytes.u32(offset);
    const auto type = bytes.u8(offset + 4);
    const auto sample_size = bytes.u8(offset + 5);
    const auto count = bytes.u16(offset + 6);
    if (!key || *key == 0 || !count) return items;
    const std::size_t size = std::size_t{*sample_size} * *count;
    const auto data = bytes.part(offset + kHeader, size);
    if (!data) return items;
    items.push_back({*key, *type, *sample_size, *count, *data});
    offset += kHeader + (size + 3) / 4 * 4;
  }
}

std::size_t size_of_number(std::uint8_t type) {
  switch (type) {
    case 'b':
    case 'B':
      return 1;
    case 's':
    case 'S':
      return 2;
    case 'l':
    case 'L':
    case 'f':
      return 4;
    case 'j':
    case 'J':
    case 'd':
      return 8;
    default:
      return 0;  // text or a structure
  }
}

/// The number at `offset`, which must be there.
double number_at(ByteView data, std::size_t offset, std::uint8_t type) {
  switch (type) {
    case 'b':
      return static_cast<std::int8_t>(*data.u8(offset));
    case 'B':
      return *data.u8(offset);
    case 's':
      return static_cast<std::int16_t>(*data.u16(offset));
    case 'S':
      return *data.u16(offset);
    case 'l':
      return static_cast<std::int32_t>(*data.u32(offset));
    case 'L':
      return *data.u32(offset);
    case 'f':
      return std::bit_cast<float>(*data.u32(offset));
    case 'j':
      return static_cast<double>(static_cast<std::int64_t>(*data.u64(offset)));
    case 'J':
      return static_cast<double>(*data.u64(offset));
    case 'd':
      return std::bit_cast<double>(*data.u64(offset));
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

std::vector<double> numbers_of(const Item& item) {
  const std::size_t size = size_of_number(item.type);
  if (size == 0) return {};
  std::vector<double> numbers(item.data.size() / size);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    numbers[i] = number_at(item.data, i * size, item.type);
  }
  return numbers;
}

/// Microseconds or milliseconds as nanoseconds; nothing if that does not fit.
std::optional<SensorDuration> stamp_of(const Item& item, std::int64_t nanoseconds_per_unit) {
  const std::optional<std::uint64_t> units =
      item.type == 'J' ? item.data.u64(0) : std::optional<std::uint64_t>(item.data.u32(0));
  const auto most = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max() /
                                               nanoseconds_per_unit / 4);
  if (!units || *units > most) return std::nullopt;
  return SensorDuration(static_cast<std::int64_t>(*units) * nanoseconds_per_unit);
}

/// One divisor for all columns, or one for each.
void divide(std::vector<double>& values, std::size_t columns, const std::vector<double>& divisors) {
  if (divisors.size() != 1 && divisors.size() != columns) return;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] /= divisors[divisors.size() == 1 ? 0 : i % columns];
  }
}

/// The last item is the data, those before it describe it.
GpmfStream parse_stream(ByteView content) {
  constexpr std::int64_t kMicrosecond = 1'000;
  constexpr std::int64_t kMillisecond = 1'000'000;
  constexpr double kFixOf2d = 2;
  GpmfStream stream;
  std::vector<double> divisors{1.0};
  double gps_fix = 0;
  const std::vector<Item> items = items_of(content);
  for (const Item& item : items) {
    if (item.key == four_cc("STMP")) stream.stamp = stamp_of(item, kMicrosecond);
    if (item.key == four_cc("TICK") && !stream.stamp) stream.stamp = stamp_of(item, kMillisecond);
    if (item.key == four_cc("SCAL")) divisors = numbers_of(item);
    if (item.key == four_cc("ORIN")) stream.orientation_in = item.data.text();
    if (item.key == four_cc("GPSF") && item.data.size() >= 4) gps_fix = *item.data.u32(0);
    if (item.key == four_cc("GPSU") && gps_fix >= kFixOf2d) stream.utc = item.data.text();
  }
  if (items.empty()) return stream;
  const Item& data = items.back();
  const std::size_t number_size = size_of_number(data.type);
  if (number_size == 0 || data.sample_size < number_size) return stream;
  stream.key = data.key;
  stream.columns = data.sample_size / number_size;
  stream.values = numbers_of(data);
  divide(stream.values, stream.columns, divisors);
  return stream;
}

}  // namespace

std::vector<GpmfDevice> parse_gpmf(ByteView payload) {
  std::vector<GpmfDevice> devices;
  for (const Item& device_item : items_of(payload)) {
    if (device_item.key != four_cc("DEVC") || device_item.type != kNested) continue;
    GpmfDevice device;
    for (const Item& item : items_of(device_item.data)) {
      if (item.key == four_cc("DVNM")) device.name = item.data.text();
      if (item.key == four_cc("STRM") && item.type == kNested) {
        device.streams.push_back(parse_stream(item.data));
      }
    }
    devices.push_back(std::move(device));
  }
  return devices;
}

}  // namespace gimbal

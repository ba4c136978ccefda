#include "drivers/libcamera/control_values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

namespace gimbal {
namespace {

std::optional<double> number_of(const libcamera::ControlValue& value) {
  if (value.isArray()) return std::nullopt;
  switch (value.type()) {
    case libcamera::ControlTypeBool:
      return value.get<bool>() ? 1 : 0;
    case libcamera::ControlTypeByte:
      return value.get<std::uint8_t>();
    case libcamera::ControlTypeInteger32:
      return value.get<std::int32_t>();
    case libcamera::ControlTypeInteger64:
      return static_cast<double>(value.get<std::int64_t>());
    case libcamera::ControlTypeFloat:
      return value.get<float>();
    default:
      return std::nullopt;
  }
}

/// Whole numbers of a type that holds no others.
template <typename T>
bool can_hold(double number) {
  if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(number);
  } else {
    // The upper limit of 64 bits is no double; the next one above it is.
    return std::trunc(number) == number &&
           number >= static_cast<double>(std::numeric_limits<T>::min()) &&
           number < std::ldexp(1.0, std::numeric_limits<T>::digits);
  }
}

template <typename T>
std::optional<libcamera::ControlValue> typed_value(const std::vector<double>& numbers) {
  if (!std::ranges::all_of(numbers, can_hold<T>)) return std::nullopt;
  if (numbers.size() == 1) return libcamera::ControlValue(static_cast<T>(numbers[0]));
  const auto typed = std::make_unique<T[]>(numbers.size());  // a vector<bool> is no array
  std::ranges::transform(numbers, typed.get(), [](double n) { return static_cast<T>(n); });
  return libcamera::ControlValue(libcamera::Span<const T>(typed.get(), numbers.size()));
}

std::optional<libcamera::ControlValue> value_of_type(libcamera::ControlType type,
                                                     const std::vector<double>& numbers) {
  switch (type) {
    case libcamera::ControlTypeBool:
      return typed_value<bool>(numbers);
    case libcamera::ControlTypeByte:
      return typed_value<std::uint8_t>(numbers);
    case libcamera::ControlTypeInteger32:
      return typed_value<std::int32_t>(numbers);
    case libcamera::ControlTypeInteger64:
      return typed_value<std::int64_t>(numbers);
    case libcamera::ControlTypeFloat:
      return typed_value<float>(numbers);
    default:
      return std::nullopt;
  }
}

}  // namespace

Result<libcamera::ControlValue> control_value(const libcamera::ControlId& id,
                                              const libcamera::ControlInfo& info,
                                              const std::vector<double>& numbers) {
  if (numbers.empty()) return bad_input(fmt::format("control {} has no value", id.name()));
  const auto value = value_of_type(id.type(), numbers);
  if (!value) {
    return bad_input(
        fmt::format("control {} does not take {}", id.name(), fmt::join(numbers, ", ")));
  }
  const auto low = number_of(info.min());
  const auto high = number_of(info.max());
  for (const double number : numbers) {
    if ((low && number < *low) || (high && number > *high)) {
      return bad_input(
          fmt::format("control {} is {}, and has to be {}", id.name(), number, info.toString()));
    }
  }
  return *value;
}

Result<libcamera::ControlList> control_list(
    const libcamera::ControlInfoMap& known,
    const std::map<std::string, std::vector<double>>& values) {
  libcamera::ControlList list(known);
  for (const auto& [name, numbers] : values) {
    const auto found =
        std::find_if(known.begin(), known.end(),
                     [&wanted = name](const auto& entry) { return entry.first->name() == wanted; });
    if (found == known.end()) {
      std::vector<std::string> names;
      for (const auto& [id, info] : known) names.push_back(id->name());
      std::ranges::sort(names);
      return bad_input(fmt::format("has no control {}; it has {}", name, fmt::join(names, ", ")));
    }
    const auto value = control_value(*found->first, found->second, numbers);
    if (!value) return tl::unexpected(value.error());
    list.set(found->first->id(), *value);
  }
  return list;
}

}  // namespace gimbal

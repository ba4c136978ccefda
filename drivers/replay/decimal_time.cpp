#include "drivers/replay/decimal_time.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

namespace gimbal {

namespace {

constexpr std::int64_t kNanosecondDigits = 9;

/// digits * 10^exponent, without sign.
struct Decimal {
  std::string digits;
  std::int64_t exponent = 0;
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

std::optional<Decimal> parse_decimal(std::string_view text) {
  Decimal decimal;
  bool after_point = false;
  std::size_t i = 0;
  for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && !after_point)); ++i) {
    if (text[i] == '.') {
      after_point = true;
      continue;
    }
    decimal.digits += text[i];
    if (after_point) --decimal.exponent;
  }
  if (decimal.digits.empty()) return std::nullopt;
  if (i == text.size()) return decimal;
  if (text[i] != 'e' && text[i] != 'E') return std::nullopt;
  ++i;
  if (i < text.size() && text[i] == '+') ++i;
  int exponent = 0;
  const auto [end, error] = std::from_chars(text.data() + i, text.data() + text.size(), exponent);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  decimal.exponent += exponent;
  return decimal;
}

/// Nearest whole number, halves away from zero; nothing above half of what an int64 holds.
std::optional<std::int64_t> round_to_integer(const Decimal& decimal) {
  constexpr auto kMax = std::numeric_limits<std::int64_t>::max() / 2;
  const std::size_t leading_zeros =
      std::min(decimal.digits.find_first_not_of('0'), decimal.digits.size());
  const std::string_view digits = std::string_view(decimal.digits).substr(leading_zeros);
  if (digits.empty()) return 0;
  const std::int64_t whole_digits = std::ssize(digits) + decimal.exponent;
  if (whole_digits > std::numeric_limits<std::int64_t>::digits10 + 1) return std::nullopt;
  std::int64_t value = 0;
  for (std::int64_t i = 0; i < whole_digits; ++i) {
    const int digit = i < std::ssize(digits) ? digits[static_cast<std::size_t>(i)] - '0' : 0;
    if (value > (kMax - digit) / 10) return std::nullopt;
    value = value * 10 + digit;
  }
  const bool rounds_up = whole_digits >= 0 && whole_digits < std::ssize(digits) &&
                         digits[static_cast<std::size_t>(whole_digits)] >= '5';
  if (rounds_up && value == kMax) return std::nullopt;
  return value + (rounds_up ? 1 : 0);
}

/// What is no decimal number may still be "nan", "inf" or the like.
TimeTextFault fault_of(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_special =
      error == std::errc() && end == text.data() + text.size() && !std::isfinite(value);
  return is_special ? TimeTextFault::not_finite : TimeTextFault::not_a_number;
}

}  // namespace

tl::expected<SensorDuration, TimeTextFault> parse_time(std::string_view text, TimeUnit unit) {
  const bool negative = text.starts_with('-');
  const std::string_view magnitude = text.substr(negative || text.starts_with('+') ? 1 : 0);
  std::optional<Decimal> decimal = parse_decimal(magnitude);
  if (!decimal) return tl::unexpected(fault_of(magnitude));
  decimal->exponent += kNanosecondDigits + static_cast<int>(unit);
  const std::optional<std::int64_t> nanoseconds = round_to_integer(*decimal);
  if (!nanoseconds) return tl::unexpected(TimeTextFault::out_of_range);
  return SensorDuration(negative ? -*nanoseconds : *nanoseconds);
}

std::string format_seconds(SensorDuration duration) {
  constexpr std::uint64_t kPerSecond = 1'000'000'000;
  const auto count = static_cast<std::uint64_t>(duration.count());
  const bool negative = duration.count() < 0;
  const std::uint64_t magnitude = negative ? std::uint64_t{0} - count : count;
  return fmt::format("{}{}.{:09}", negative ? "-" : "", magnitude / kPerSecond,
                     magnitude % kPerSecond);
}

}  // namespace gimbal

#include "drivers/iio/sampling_frequency.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <vector>

namespace gimbal {
namespace {

/// What is in the text between spaces and brackets, as far as it is a number above zero.
std::vector<double> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const auto begin = text.find_first_not_of(" \n[]");
    if (begin == std::string_view::npos) return numbers;
    text.remove_prefix(begin);
    const auto length = std::min(text.find_first_of(" \n[]"), text.size());
    double number = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + length, number);
    if (parsed.ec == std::errc() && number > 0) numbers.push_back(number);
    text.remove_prefix(length);
  }
}

bool is_range(std::string_view text) {
  return text.find('[') != std::string_view::npos;
}

double nearest_in_range(double least, double step, double most, double wish) {
  const double steps = std::ceil((wish - least) / step - 1e-9);
  return std::clamp(least + std::max(steps, 0.0) * step, least, most);
}

}  // namespace

std::optional<double> nearest_frequency(std::string_view available, double wish_hz) {
  std::vector<double> offers = numbers_in(available);
  if (offers.empty()) return std::nullopt;
  if (is_range(available) && offers.size() == 3) {
    return nearest_in_range(offers[0], offers[1], offers[2], wish_hz);
  }
  std::sort(offers.begin(), offers.end());
  // A chip's 99.99 is what a person means by 100.
  const auto offer = std::lower_bound(offers.begin(), offers.end(), 0.99 * wish_hz);
  return offer != offers.end() ? *offer : offers.back();
}

std::optional<double> highest_frequency(std::string_view available) {
  return nearest_frequency(available, std::numeric_limits<double>::max());
}

}  // namespace gimbal

#include "daemon/gimbalctl/picture_size.hpp"

#include <fmt/format.h>

#include <charconv>

namespace gimbal {

Result<ImageSize> parse_picture_size(const std::string& text) {
  ImageSize size;
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size.width);
  if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
    const auto height = std::from_chars(width.ptr + 1, end, size.height);
    const bool whole = height.ec == std::errc() && height.ptr == end;
    const auto fits = [](int side) { return side >= 16 && side <= 8192 && side % 2 == 0; };
    if (whole && fits(size.width) && fits(size.height)) return size;
  }
  return bad_input(fmt::format(
      "--size {}: write WIDTHxHEIGHT, such as 1280x720, each even and from 16 to 8192", text));
}

}  // namespace gimbal

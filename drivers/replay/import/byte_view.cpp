#include "drivers/replay/import/byte_view.hpp"

#include <algorithm>

namespace gimbal {

std::optional<std::uint64_t> ByteView::big_endian(std::size_t offset, std::size_t size) const {
  const std::optional<ByteView> field = part(offset, size);
  if (!field) return std::nullopt;
  std::uint64_t value = 0;
  for (const std::uint8_t byte : field->bytes_) value = value << 8 | byte;
  return value;
}

std::optional<std::uint8_t> ByteView::u8(std::size_t offset) const {
  const auto value = big_endian(offset, 1);
  return value ? std::optional(static_cast<std::uint8_t>(*value)) : std::nullopt;
}

std::optional<std::uint16_t> ByteView::u16(std::size_t offset) const {
  const auto value = big_endian(offset, 2);
  return value ? std::optional(static_cast<std::uint16_t>(*value)) : std::nullopt;
}

std::optional<std::uint32_t> ByteView::u32(std::size_t offset) const {
  const auto value = big_endian(offset, 4);
  return value ? std::optional(static_cast<std::uint32_t>(*value)) : std::nullopt;
}

std::optional<std::uint64_t> ByteView::u64(std::size_t offset) const {
  return big_endian(offset, 8);
}

std::optional<ByteView> ByteView::part(std::size_t offset, std::size_t size) const {
  if (offset > bytes_.size() || size > bytes_.size() - offset) return std::nullopt;
  return ByteView(bytes_.subspan(offset, size));
}

ByteView ByteView::from(std::size_t offset) const {
  return ByteView(bytes_.subspan(std::min(offset, bytes_.size())));
}

std::string ByteView::text() const {
  const auto is_printable = [](std::uint8_t byte) { return byte >= 0x20 && byte < 0x7f; };
  return {bytes_.begin(), std::find_if_not(bytes_.begin(), bytes_.end(), is_printable)};
}

}  // namespace gimbal

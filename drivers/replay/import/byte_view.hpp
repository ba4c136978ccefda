#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace gimbal {

/// Four letters that name a box or a key, first letter in the highest byte.
using FourCc = std::uint32_t;

constexpr FourCc four_cc(const char (&name)[5]) {
  FourCc code = 0;
  for (int i = 0; i < 4; ++i) code = code << 8 | static_cast<unsigned char>(name[i]);
  return code;
}

/// Bytes of a file that is not trusted, numbers being big-endian. Whatever is asked for outside of
/// them is not there.
class ByteView {
 public:
  ByteView() = default;
  explicit ByteView(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

  [[nodiscard]] std::optional<std::uint8_t> u8(std::size_t offset) const;
  [[nodiscard]] std::optional<std::uint16_t> u16(std::size_t offset) const;
  [[nodiscard]] std::optional<std::uint32_t> u32(std::size_t offset) const;
  [[nodiscard]] std::optional<std::uint64_t> u64(std::size_t offset) const;

  /// Nothing unless all of it is there.
  [[nodiscard]] std::optional<ByteView> part(std::size_t offset, std::size_t size) const;

  /// All from `offset` on; empty beyond the end.
  [[nodiscard]] ByteView from(std::size_t offset) const;

  /// Printable ASCII up to the first other byte.
  [[nodiscard]] std::string text() const;

 private:
  [[nodiscard]] std::optional<std::uint64_t> big_endian(std::size_t offset, std::size_t size) const;

  std::span<const std::uint8_t> bytes_;
};

}  // namespace gimbal

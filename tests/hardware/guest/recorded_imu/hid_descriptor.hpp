#pragma once

#include <cstdint>
#include <vector>

namespace gimbal {

/// The report descriptor of a hub with two sensors: what each report's bits are, in the short items
/// of "Device Class Definition for HID 1.11", section 6.2.2. Each item has four bytes of data; a
/// usage of that length brings its page with it.
class HidDescriptor {
 public:
  enum class Item : std::uint8_t {
    usage_page = 0x04,
    logical_minimum = 0x14,
    logical_maximum = 0x24,
    unit_exponent = 0x54,
    unit = 0x64,
    report_size = 0x74,
    report_id = 0x84,
    report_count = 0x94,
    usage = 0x08,
    input = 0x80,
    feature = 0xb0,
    collection = 0xa0,
  };

  void add(Item item, std::int32_t value) {
    const auto bits = static_cast<std::uint32_t>(value);
    bytes_.push_back(static_cast<std::uint8_t>(static_cast<unsigned>(item) | kFourBytes));
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes_.push_back(static_cast<std::uint8_t>(bits >> shift & 0xff));
    }
  }

  void end_collection() { bytes_.push_back(0xc0); }

  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  static constexpr unsigned kFourBytes = 3;  ///< the size code of a short item

  std::vector<std::uint8_t> bytes_;
};

}  // namespace gimbal

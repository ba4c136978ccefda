#pragma once

#include <cstdint>
#include <optional>

namespace gimbal {

/// Counts on from the sequence numbers of buffers, which are 32 bits wide.
class SequenceCounter {
 public:
  struct Step {
    std::int64_t index = 0;  ///< of the frame, 0 for the first
    std::uint64_t lost = 0;  ///< between the last frame and this one
  };

  /// A number that does not rise (some drivers leave it at 0) counts as the next one.
  [[nodiscard]] Step next(std::uint32_t sequence);

 private:
  std::optional<std::uint32_t> last_;
  std::int64_t index_ = 0;
};

}  // namespace gimbal

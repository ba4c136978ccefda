#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Decodes single JPEG pictures, one after the other.
class MjpegDecoder {
 public:
  MjpegDecoder();

  /// Nothing if the picture is cut off, damaged, or of another size. What follows its end, such as
  /// padding, does not matter.
  [[nodiscard]] std::optional<Nv12Buffer> decode(std::span<const std::uint8_t> jpeg,
                                                 ImageSize size);

 private:
  std::unique_ptr<void, int (*)(void*)> handle_;
  std::vector<std::uint8_t> planes_;
};

}  // namespace gimbal

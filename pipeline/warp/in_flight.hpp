#pragma once

#include <cstddef>

namespace gimbal {

/// Frames that the GPU is given before the first is waited for: it draws one while the processor is
/// busy with another. More would only come later, and hold more of the camera's memory.
inline constexpr std::size_t kMostInFlight = 2;

}  // namespace gimbal

#pragma once

#include <cstdint>
#include <string>

#include "drivers/clock/kernel_clock.hpp"
#include "pipeline/sample/calibration.hpp"

namespace gimbal {

/// What is odd about stamps by `clock` of buffers with these flags; empty if nothing is.
[[nodiscard]] std::string oddity_of(KernelClock clock, std::uint32_t buffer_flags);

/// What the flags of a buffer say of the instant (V4L2_BUF_FLAG_TSTAMP_SRC_*); the same in a whole
/// stream.
[[nodiscard]] TimestampReference claimed_reference(std::uint32_t buffer_flags);

/// What the flags say of both, for people.
[[nodiscard]] std::string describe_stamps(std::uint32_t buffer_flags);

}  // namespace gimbal

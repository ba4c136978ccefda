#include "drivers/v4l2/stamp_clock.hpp"

#include <fmt/format.h>
#include <linux/videodev2.h>

namespace gimbal {
std::string oddity_of(KernelClock clock, std::uint32_t buffer_flags) {
  if (clock != KernelClock::monotonic) {
    return fmt::format("its stamps are by {}; they are converted to CLOCK_MONOTONIC",
                       name_of(clock));
  }
  if ((buffer_flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) != V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC) {
    return "its driver does not say by which clock it stamps; CLOCK_MONOTONIC fits";
  }
  return {};
}

TimestampReference claimed_reference(std::uint32_t buffer_flags) {
  const bool is_start =
      (buffer_flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return is_start ? TimestampReference::exposure_start : TimestampReference::readout_end;
}

std::string describe_stamps(std::uint32_t buffer_flags) {
  const std::uint32_t clock = buffer_flags & V4L2_BUF_FLAG_TIMESTAMP_MASK;
  const char* by = clock == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC ? "CLOCK_MONOTONIC"
                   : clock == V4L2_BUF_FLAG_TIMESTAMP_COPY    ? "whoever writes into it"
                                                              : "an unknown clock";
  const char* instant = claimed_reference(buffer_flags) == TimestampReference::exposure_start
                            ? "the start of exposure"
                            : "the end of the frame";
  return fmt::format("stamps: by {}, at {} (as the driver says)", by, instant);
}

}  // namespace gimbal

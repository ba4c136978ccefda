#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "drivers/v4l2/v4l2_device.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

using ReadClock = std::function<std::optional<SensorDuration>(StampClock)>;

/// "CLOCK_MONOTONIC" and so on.
[[nodiscard]] std::string name_of(StampClock clock);

/// The clock by which a stamp is a picture's that has just arrived, CLOCK_MONOTONIC before all
/// others; nothing if it is none of them. What the driver says is only a claim: NVIDIA's vi5 stamps
/// by the system counter and says CLOCK_MONOTONIC, and drivers of loopback devices say nothing.
[[nodiscard]] std::optional<StampClock> find_clock(SensorDuration stamp, const ReadClock& now);

/// What is odd about stamps by `clock` of buffers with these flags; empty if nothing is.
[[nodiscard]] std::string oddity_of(StampClock clock, std::uint32_t buffer_flags);

/// A stamp by some clock, on CLOCK_MONOTONIC. Both clocks are read anew for each stamp, so that one
/// that is slewed or set does not drift away.
[[nodiscard]] SensorTime to_monotonic(SensorDuration stamp, StampClock clock, const ReadClock& now);

/// What the flags of a buffer say of the instant (V4L2_BUF_FLAG_TSTAMP_SRC_*); the same in a whole
/// stream.
[[nodiscard]] TimestampReference claimed_reference(std::uint32_t buffer_flags);

/// What the flags say of both, for people.
[[nodiscard]] std::string describe_stamps(std::uint32_t buffer_flags);

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

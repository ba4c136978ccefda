#pragma once

#include <cstdint>
#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

enum class EdgeDirection : std::uint8_t { rising, falling };

/// A change of a digital line, such as an IMU's data-ready or a camera's strobe.
struct Edge {
  SensorTime time;    ///< as the kernel stamped it
  unsigned line = 0;  ///< number on its chip
  EdgeDirection direction = EdgeDirection::rising;
  std::uint64_t sequence = 0;  ///< counts up from 1 since `start`; a gap is what was lost
};

/// Edges in order of time. One thread starts, reads and asks; `stop` may come from another, and
/// ends a `read` that waits.
class EdgeSource {
 public:
  EdgeSource() = default;
  EdgeSource(const EdgeSource&) = delete;
  EdgeSource& operator=(const EdgeSource&) = delete;
  virtual ~EdgeSource() = default;

  /// Begins to deliver. Allowed after `stop`.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Waits for the next edge until `deadline`; nothing if none came, or after `stop`. A deadline
  /// that is over takes what is there already. Fails when the line is gone.
  [[nodiscard]] virtual Result<std::optional<Edge>> read_until(SensorTime deadline) = 0;

  virtual void stop() = 0;

  /// Edges known to have been lost, since `start`.
  [[nodiscard]] virtual std::uint64_t lost() const { return 0; }
};

}  // namespace gimbal

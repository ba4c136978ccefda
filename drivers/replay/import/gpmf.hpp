#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/replay/import/byte_view.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// What one sensor delivered in one payload of GoPro's metadata (GPMF): `values` has `columns`
/// numbers a sample, divided by SCAL.
struct GpmfStream {
  FourCc key = 0;  ///< of the data: GYRO, ACCL, SHUT
  std::size_t columns = 0;
  std::vector<double> values;
  /// Of the first sample, on the camera's clock: STMP (microseconds) or TICK (milliseconds).
  std::optional<SensorDuration> stamp;
  std::string orientation_in;  ///< ORIN: the axis of each column, a small letter for its opposite
  std::string utc;             ///< GPSU, yymmddhhmmss.sss; empty without a fix

  [[nodiscard]] std::size_t sample_count() const {
    return columns == 0 ? 0 : values.size() / columns;
  }
};

struct GpmfDevice {
  std::string name;  ///< DVNM
  std::vector<GpmfStream> streams;
};

/// A payload's devices, in order. The bytes are not trusted: what does not fit into what it is in
/// is left out. Source: GoPro's description of the format (github.com/gopro/gpmf-parser).
[[nodiscard]] std::vector<GpmfDevice> parse_gpmf(ByteView payload);

}  // namespace gimbal

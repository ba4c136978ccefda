#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// What a camera delivers, known once it is open.
struct CameraFormat {
  ImageSize size;
  double fps = 0;
  ColorInfo color;
  std::optional<SensorDuration> readout = {};        ///< where the sensor tells it
  std::optional<TimestampReference> timestamp = {};  ///< where the sensor tells it
  std::vector<std::string> warnings = {};            ///< what is odd about the device, a line each
};

/// How a source's frames lie in memory.
enum class PictureForm : std::uint8_t {
  nv12,
  native,  ///< as the device laid them out, where VideoFrame has a name for that
};

/// Frames, one after the other. Owns no policy: whoever reads decides what to drop. One thread
/// starts, reads and asks; `stop` may come from another, and ends a `read` that waits.
class CameraSource {
 public:
  CameraSource() = default;
  CameraSource(const CameraSource&) = delete;
  CameraSource& operator=(const CameraSource&) = delete;
  virtual ~CameraSource() = default;

  /// Begins to deliver; a replay begins at its first frame again. Allowed after `stop`.
  [[nodiscard]] virtual Result<void> start() = 0;

  /// Valid after `start`.
  [[nodiscard]] virtual CameraFormat format() const = 0;

  /// How frames may come from the next one on: NV12 alone, unless `native` is said, too. On the
  /// thread that reads, or before there is one.
  virtual void ask_for(PictureForm /*form*/) {}

  /// Waits for the next frame; nothing at the end of a recording or after `stop`. Stamps rise.
  /// Fails within a few seconds when the device is gone or has fallen silent; `start` may bring it
  /// back.
  [[nodiscard]] virtual Result<std::optional<VideoFrame>> read() = 0;

  virtual void stop() = 0;

  /// Frames that the device took and that did not come out of `read`, since `start`.
  [[nodiscard]] virtual std::uint64_t lost() const { return 0; }

  /// What a person should know of what it delivered since `start`, one line each, such as a
  /// recording that is cut short. Bounded.
  [[nodiscard]] virtual std::vector<std::string> remarks() const { return {}; }
};

}  // namespace gimbal

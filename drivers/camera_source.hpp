#pragma once

#include <optional>

#include "pipeline/sample/result.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// What a camera delivers, known once it is open.
struct CameraFormat {
  ImageSize size;
  double fps = 0;
  ColorInfo color;
};

/// Frames, one after the other. Owns no policy: whoever reads decides what to drop.
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

  /// Waits for the next frame; nothing at the end of a recording or after `stop`. Stamps rise.
  [[nodiscard]] virtual Result<std::optional<VideoFrame>> read() = 0;

  virtual void stop() = 0;
};

}  // namespace gimbal

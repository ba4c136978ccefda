#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "drivers/camera_source.hpp"
#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/panorama.hpp"
#include "drivers/synthetic/picture_renderer.hpp"
#include "drivers/synthetic/sensor_noise.hpp"
#include "pipeline/sample/calibration.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

struct SyntheticCameraSettings {
  CameraCalibration calibration;
  SensorDuration exposure{};
  SensorTime first_readout;          ///< true time when the first frame's readout starts
  std::int64_t frames = 0;           ///< captured; those that are dropped are not delivered
  SensorDuration interval_jitter{};  ///< standard deviation of a frame's start, known to its stamp
  double drop_probability = 0;       ///< of each frame but the first
  std::optional<PixelNoise> noise;
  std::uint64_t seed = 0;
};

/// A camera with a rolling shutter that looks at a panorama along a motion, and tells the truth of
/// each of its lines. True time is the motion's, and the IMU's clock.
class SyntheticCamera : public CameraSource {
 public:
  /// Refuses sizes, frame rates, exposures and readouts that no camera has.
  [[nodiscard]] static Result<std::unique_ptr<SyntheticCamera>> create(
      const SyntheticCameraSettings& settings, std::shared_ptr<const Motion> motion,
      std::shared_ptr<const Panorama> panorama);

  Result<void> start() override;
  [[nodiscard]] CameraFormat format() const override;
  Result<std::optional<VideoFrame>> read() override;
  void stop() override;

  /// Frames that are delivered, with indices 0, 1, 2...
  [[nodiscard]] std::size_t frame_count() const { return readout_starts_.size(); }
  [[nodiscard]] FrameStamp stamp(std::size_t frame) const;

  /// Lines along the readout axis: rows, or columns for sensors that read columns.
  [[nodiscard]] int line_count() const;

  /// Middle of a line's exposure in true time.
  [[nodiscard]] SensorTime time_of_line(std::size_t frame, int line) const;

 private:
  SyntheticCamera(SyntheticCameraSettings settings, std::shared_ptr<const Motion> motion,
                  PictureRenderer renderer);

  [[nodiscard]] std::vector<Eigen::Matrix3f> expose(std::size_t frame, int line) const;

  SyntheticCameraSettings settings_;
  std::shared_ptr<const Motion> motion_;
  PictureRenderer renderer_;
  std::vector<SensorTime> readout_starts_;  ///< true time, of the frames delivered
  std::size_t next_frame_ = 0;
  std::atomic<bool> running_ = false;
};

}  // namespace gimbal

#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "drivers/camera_source.hpp"
#include "drivers/clock/kernel_clock.hpp"
#include "drivers/clock/sequence_counter.hpp"
#include "drivers/libcamera/camera_session.hpp"
#include "drivers/libcamera/libcamera_camera.hpp"

namespace gimbal {

/// The camera of `open_libcamera_camera`.
class LibcameraSource final : public CameraSource {
 public:
  explicit LibcameraSource(LibcameraSettings settings);
  ~LibcameraSource() override;

  /// Returns once the first picture is there, whose stamp has been checked.
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] CameraFormat format() const override { return format_; }
  void ask_for(PictureForm form) override { form_ = form; }
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override;
  void stop() override;
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }

 private:
  [[nodiscard]] Result<void> begin();
  [[nodiscard]] Result<void> judge_first_picture();
  [[nodiscard]] Result<std::optional<CapturedPicture>> next_sound_picture(SensorDuration limit);
  [[nodiscard]] VideoFrame frame_of(const CapturedPicture& picture, const FrameStamp& stamp) const;
  [[nodiscard]] std::shared_ptr<CameraSession> session() const;
  void forget_session();
  [[nodiscard]] Error at_camera(const Error& error) const;

  LibcameraSettings settings_;

  // Of the thread that reads.
  std::string id_;
  CameraFormat format_;
  PictureForm form_ = PictureForm::nv12;
  KernelClock clock_ = KernelClock::monotonic;
  SequenceCounter sequence_;
  std::optional<CapturedPicture> first_;  ///< that `start` has waited for
  SensorTime last_time_;
  std::int64_t index_ = 0;
  int refused_ = 0;  ///< pictures in a row

  std::atomic<std::uint64_t> lost_ = 0;
  mutable std::mutex mutex_;  ///< for the pointer
  std::shared_ptr<CameraSession> session_;
};

}  // namespace gimbal

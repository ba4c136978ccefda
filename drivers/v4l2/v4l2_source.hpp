#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "drivers/camera_source.hpp"
#include "drivers/clock/sequence_counter.hpp"
#include "drivers/v4l2/picture_reader.hpp"
#include "drivers/v4l2/picture_stream.hpp"
#include "drivers/v4l2/stamp_clock.hpp"
#include "drivers/v4l2/v4l2_camera.hpp"
#include "drivers/v4l2/v4l2_device.hpp"
#include "drivers/v4l2/v4l2_node.hpp"

namespace gimbal {

/// The camera of `open_v4l2_camera`, on any system's nodes.
class V4l2Source final : public CameraSource {
 public:
  V4l2Source(V4l2CameraSettings settings, std::shared_ptr<const V4l2System> system);
  ~V4l2Source() override;

  /// Returns once the first picture is there, whose stamp has been checked.
  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] CameraFormat format() const override { return format_; }
  void ask_for(PictureForm form) override { form_ = form; }
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override;
  void stop() override;
  [[nodiscard]] std::uint64_t lost() const override { return lost_; }

 private:
  [[nodiscard]] Result<PictureFormat> set_up(V4l2Node& node);
  [[nodiscard]] CameraFormat format_of(V4l2Node& node, const PictureFormat& pictures) const;
  [[nodiscard]] Result<void> begin(V4l2Node node);
  [[nodiscard]] Result<void> judge_stamps();
  [[nodiscard]] Result<std::optional<FilledBuffer>> next_sound_buffer(SensorDuration limit);
  [[nodiscard]] std::optional<VideoFrame> frame_of(const FilledBuffer& buffer);
  [[nodiscard]] SensorTime time_of(const FilledBuffer& buffer) const;
  [[nodiscard]] ReadClock clocks() const;
  [[nodiscard]] std::shared_ptr<PictureStream> stream() const;
  void forget_stream();
  [[nodiscard]] Error at_camera(const Error& error) const;

  V4l2CameraSettings settings_;
  std::shared_ptr<const V4l2System> system_;

  // Of the thread that reads.
  std::string path_;
  CameraFormat format_;
  PictureForm form_ = PictureForm::nv12;
  std::optional<PictureReader> reader_;
  std::optional<SensorDuration> exposure_;
  KernelClock clock_ = KernelClock::monotonic;
  SequenceCounter sequence_;
  std::optional<FilledBuffer> first_;  ///< that `start` has waited for
  SensorTime last_time_;
  std::int64_t index_ = 0;
  int refused_ = 0;  ///< pictures in a row

  std::atomic<std::uint64_t> lost_ = 0;
  mutable std::mutex mutex_;  ///< for the pointer
  std::shared_ptr<PictureStream> stream_;
};

}  // namespace gimbal

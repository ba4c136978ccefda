#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"

namespace gimbal {

class VideoDecoder;

/// The frames of a recording. Each picture gets the stamp of the recording's frame list that has
/// its place in the video as index, and is left out where there is none; the video file's own times
/// are never used. Pictures are handed over in GStreamer's memory, not copied. `stop` may be called
/// while another thread waits in `read`.
class ReplayCamera final : public CameraSource {
 public:
  /// `stamps`: indices rise. `fps`: the nominal rate; 0 takes what the video file says.
  ReplayCamera(std::filesystem::path video, std::vector<FrameStamp> stamps, double fps);
  ~ReplayCamera() override;

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] CameraFormat format() const override { return format_; }

  /// Ends with the shorter of the two, video and frame list. A damaged video ends early.
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override;

  void stop() override;

  /// Where the picture that was read last lies on the video file's own clock: only for what else is
  /// in that file, its audio.
  [[nodiscard]] SensorDuration media_time() const { return media_time_; }

  /// Pictures left out since the frame list has no stamp for them. Known once `read` gave nothing.
  [[nodiscard]] std::int64_t frames_without_stamp() const { return frames_without_stamp_; }

  /// Entries of the frame list for which there was no picture. Known once `read` gave nothing.
  [[nodiscard]] std::int64_t stamps_without_frame() const { return stamps_without_frame_; }

  /// What was odd, a line each. Known once `read` gave nothing.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  [[nodiscard]] Result<void> skip_pictures_without_stamp();
  [[nodiscard]] Result<std::optional<VideoFrame>> end_of_video();
  [[nodiscard]] Result<void> count_rest();

  std::filesystem::path video_;
  std::vector<FrameStamp> stamps_;
  double fps_;
  CameraFormat format_;
  std::unique_ptr<VideoDecoder> decoder_;
  std::size_t next_ = 0;      ///< of the stamps
  std::int64_t picture_ = 0;  ///< place in the video of the next picture
  bool has_ended_ = false;
  SensorDuration media_time_{};
  std::int64_t frames_without_stamp_ = 0;
  std::int64_t stamps_without_frame_ = 0;
  std::vector<std::string> warnings_;
};

}  // namespace gimbal

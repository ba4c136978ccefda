#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera_source.hpp"

namespace gimbal {

class ChromaWeaver;
struct MappedPicture;
class SurplusGauge;
class VideoDecoder;

/// The frames of a recording. Each picture gets the stamp of the recording's frame list that has
/// its place in the video as index, and is left out where there is none. The video file's own times
/// only tell places: in a damaged video they leave room for pictures that cannot be decoded.
/// Pictures are handed over in GStreamer's memory; of I420 that becomes NV12, the luma. `stop` may
/// be called while another thread waits in `read`.
class ReplayCamera final : public CameraSource {
 public:
  /// `stamps`: indices rise. `fps`: the nominal rate; 0 takes what the video file says.
  ReplayCamera(std::filesystem::path video, std::vector<FrameStamp> stamps, double fps);
  ~ReplayCamera() override;

  [[nodiscard]] Result<void> start() override;
  [[nodiscard]] CameraFormat format() const override { return format_; }

  /// Goes back to the first frame; after `start`, and on the thread that reads. Where the file can
  /// be sought in that takes less than a frame's time and no memory.
  [[nodiscard]] Result<void> rewind();

  /// Native is I420, where the decoder writes that.
  void ask_for(PictureForm form) override { form_ = form; }

  /// Ends with the shorter of the two, video and frame list. Of a damaged video pictures are
  /// missing, or it ends early.
  [[nodiscard]] Result<std::optional<VideoFrame>> read() override;

  void stop() override;

  /// Where the picture that was read last lies on the video file's own clock: only for what else is
  /// in that file, its audio, whose running time it is.
  [[nodiscard]] SensorDuration media_time() const { return media_time_; }

  /// Of all pictures so far, after the decoder has written them; after `start`.
  [[nodiscard]] std::int64_t bytes_copied() const;

  /// Pictures left out since the frame list has no stamp for them. Known once `read` gave nothing.
  [[nodiscard]] std::int64_t frames_without_stamp() const { return counts_.without_stamp; }

  /// Entries of the frame list for which there was no picture. Known once `read` gave nothing.
  [[nodiscard]] std::int64_t stamps_without_frame() const {
    return counts_.stamps_passed + static_cast<std::int64_t>(stamps_.size() - next_);
  }

  /// What was odd, a line each. Known once `read` gave nothing.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Counts {
    std::int64_t pictures = 0;
    std::int64_t without_stamp = 0;
    std::int64_t out_of_order = 0;
    std::int64_t stamps_passed = 0;  ///< without a picture, though later ones have one
  };

  void begin();
  [[nodiscard]] bool is_wanted(std::optional<SensorDuration> media_time);
  [[nodiscard]] std::int64_t place_of(std::optional<SensorDuration> media_time) const;
  [[nodiscard]] Result<std::optional<VideoFrame>> deliver(
      const std::optional<MappedPicture>& picture);
  void end_of_video();
  void warn_of_uncertain_places();
  void warn_of_leap();

  std::filesystem::path video_;
  std::vector<FrameStamp> stamps_;
  double fps_;
  CameraFormat format_;
  PictureForm form_ = PictureForm::nv12;
  std::unique_ptr<VideoDecoder> decoder_;
  std::shared_ptr<SurplusGauge> gauge_;  ///< of the decoder's pictures
  std::unique_ptr<ChromaWeaver> weaver_;
  std::int64_t coded_count_ = 0;             ///< pictures in the file, decodable or not
  std::vector<SensorDuration> coded_times_;  ///< of these, rising strictly; empty if not known
  std::size_t next_ = 0;                     ///< of the stamps
  std::int64_t place_ = -1;                  ///< in the video, of the last picture
  bool has_ended_ = false;
  SensorDuration media_time_{};
  Counts counts_;
  std::vector<std::string> warnings_;
};

}  // namespace gimbal

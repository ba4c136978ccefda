#pragma once

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/gstreamer/conversion_count.hpp"
#include "pipeline/gstreamer/gst_runtime.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sample/sensor_time.hpp"

namespace gimbal {

/// When a picture is shown on the clock that the file's streams share; nothing if the file gives no
/// time.
[[nodiscard]] std::optional<SensorDuration> media_time_of(GstSample* picture);

/// Decodes the first video stream of a file to NV12, or I420 where the decoder writes that, as fast
/// as pictures are asked for and only a few ahead of that. Rotation tags are not followed: pictures
/// come as the sensor was read.
class VideoDecoder {
 public:
  /// Decodes up to the first picture. bad_input if there is none: not a video, too damaged, or no
  /// decoder installed.
  /// `patience`: how long the file may yield nothing before that is an error.
  [[nodiscard]] static Result<std::unique_ptr<VideoDecoder>> open(
      const std::filesystem::path& path,
      std::chrono::milliseconds patience = std::chrono::seconds(30));

  /// Caps of the first picture; all of a file's pictures have the same size.
  [[nodiscard]] GstCaps* caps() const { return caps_.get(); }

  /// The next picture in order of presentation; null at the end or after `interrupt`. A damaged
  /// file ends where its last picture could be decoded, with a warning.
  [[nodiscard]] Result<GstSamplePtr> next();

  /// Goes back to the first picture, in the time of a seek. False if this file cannot be sought in,
  /// or tells other times afterwards: it is to be opened anew then.
  [[nodiscard]] Result<bool> rewind();

  /// Makes `next` return, on whatever thread it waits; nothing comes afterwards.
  void interrupt();
  [[nodiscard]] bool is_interrupted() const { return is_interrupted_; }

  /// Of all pictures so far, from one place in memory to another after the decoder has written
  /// them, which is what bringing others to NV12 does.
  [[nodiscard]] std::int64_t bytes_copied() const { return conversions_.bytes(); }

  /// What was wrong with the file so far, a line each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  VideoDecoder(std::filesystem::path path, std::chrono::milliseconds patience);

  [[nodiscard]] Result<void> start();
  [[nodiscard]] Result<GstSamplePtr> pull();
  [[nodiscard]] bool is_at_end() const;
  [[nodiscard]] bool has_video() const;
  void drain_bus();
  void note_failure(std::string text);
  [[nodiscard]] Error no_picture() const;

  std::filesystem::path path_;
  std::chrono::milliseconds patience_;
  std::atomic<bool> is_interrupted_ = false;
  std::atomic<bool> are_streams_known_ = false;
  ConversionCount conversions_;
  GstElementPtr sink_;
  GstPipelinePtr pipeline_;  // its threads use what stands above
  GstCapsPtr caps_;
  GstSamplePtr first_;  ///< until it is taken
  std::optional<SensorDuration> first_time_;
  std::optional<std::string> failure_;
  std::string missing_plugin_;
  std::vector<std::string> warnings_;
};

}  // namespace gimbal

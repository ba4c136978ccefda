#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

/// YUV4MPEG2, planar 4:2:0, uncompressed (man 5 yuv4mpeg). The format has one constant rate and no
/// times: capture times are lost, and every frame is shown for 1/fps.
class Y4mSink final : public FrameSink {
 public:
  [[nodiscard]] static Result<std::unique_ptr<FrameSink>> open_file(
      const std::filesystem::path& path, const SinkFormat& format,
      std::vector<std::string> warnings);

  /// On standard output. A reader that goes away is an error of `write`, not a signal.
  [[nodiscard]] static Result<std::unique_ptr<FrameSink>> open_stdout(
      const SinkFormat& format, std::vector<std::string> warnings);

  ~Y4mSink() override;

  [[nodiscard]] Result<void> write(const VideoFrame& frame) override;
  [[nodiscard]] Result<void> finish() override;
  [[nodiscard]] std::optional<std::int64_t> bytes_copied() const override { return bytes_copied_; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }

 private:
  Y4mSink(int descriptor, std::string name, const SinkFormat& format,
          std::vector<std::string> warnings);
  [[nodiscard]] Result<void> write_bytes();
  [[nodiscard]] Result<void> close_file();

  int descriptor_;  ///< below zero once closed
  std::string name_;
  SinkFormat format_;
  std::vector<std::string> warnings_;
  std::vector<std::uint8_t> bytes_;  ///< of the header, then of one frame after the other
  std::int64_t frames_written_ = 0;
  std::int64_t bytes_copied_ = 0;
};

}  // namespace gimbal

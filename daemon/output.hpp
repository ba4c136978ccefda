#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <thread>

#include "daemon/histogram.hpp"
#include "daemon/output_target.hpp"
#include "pipeline/sample/video_frame.hpp"

namespace gimbal {

/// Starting: not opened yet, which takes a while where GStreamer must look for its plugins first.
/// Failed: until it is open again.
enum class OutputState : std::uint8_t { starting, working, failed };

/// One consumer of the steady pictures, on a thread of its own: while it is slow, or being opened
/// again after a failure, the newest pictures win and the others are counted, and nobody else
/// waits.
class Output {
 public:
  /// `delay`: the longest that a frame is behind its stamp when it is offered.
  Output(OutputTarget target, double fps, SensorDuration delay);
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;
  ~Output();

  void offer(const VideoFrame& frame);

  /// Nothing more is offered: what is held is written, and the stream is ended properly.
  void end();

  /// Waits until that is done, six seconds at most. An output that does not get on, such as a pipe
  /// that nobody reads, is named and left to itself sooner.
  void finish();

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] std::uint64_t written() const;
  [[nodiscard]] std::uint64_t dropped() const;

  /// How long a frame took to be written, and how old it was then.
  [[nodiscard]] Histogram::Counts writing_time() const;
  [[nodiscard]] Histogram::Counts written_age() const;
  [[nodiscard]] std::size_t queued() const;

  [[nodiscard]] OutputState state() const;

  /// Whether it failed and cannot be opened again: a file that was open, or that never was until
  /// the end, or standard output that nobody reads.
  [[nodiscard]] bool is_gone() const;

 private:
  class Writer;

  std::shared_ptr<Writer> writer_;  ///< shared with the thread, which may be left behind
  std::thread thread_;
  std::future<void> ended_;
};

}  // namespace gimbal

#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "daemon/histogram.hpp"
#include "daemon/output_target.hpp"
#include "pipeline/queue/bounded_queue.hpp"
#include "pipeline/sample/video_frame.hpp"
#include "pipeline/sink/frame_sink.hpp"

namespace gimbal {

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

  void offer(const VideoFrame& frame) { frames_.push(frame); }

  /// Writes what is held and ends the stream properly.
  void finish();

  [[nodiscard]] const std::string& name() const { return target_.name; }
  [[nodiscard]] std::uint64_t written() const { return written_; }
  [[nodiscard]] std::uint64_t dropped() const { return frames_.dropped() + lost_; }

  /// How long a frame took to be written, and how old it was then.
  [[nodiscard]] Histogram::Counts writing_time() const { return writing_time_.counts(); }
  [[nodiscard]] Histogram::Counts written_age() const { return written_age_.counts(); }
  [[nodiscard]] std::size_t queued() const { return frames_.size(); }

  /// Whether it takes frames; false from a failure until it is open again.
  [[nodiscard]] bool works() const { return works_; }

  /// Whether it failed and cannot be opened again: a file, or standard output that nobody reads.
  [[nodiscard]] bool is_gone() const { return is_gone_; }

 private:
  void run();
  [[nodiscard]] bool write(const VideoFrame& frame);
  [[nodiscard]] Result<void> open_for(const VideoFrame& frame);
  void fail(const Error& error);
  void close();

  const OutputTarget target_;
  const double fps_;
  const SensorDuration delay_;
  BoundedQueue<VideoFrame, WhenFull::drop_oldest> frames_;
  std::unique_ptr<FrameSink> sink_;
  std::chrono::steady_clock::time_point next_try_;
  std::chrono::seconds backoff_;
  std::atomic<std::uint64_t> written_ = 0;
  std::atomic<std::uint64_t> lost_ = 0;  ///< while there was no sink
  std::atomic<bool> works_ = true;
  std::atomic<bool> is_gone_ = false;
  Histogram writing_time_;
  Histogram written_age_;
  std::thread thread_;
};

}  // namespace gimbal

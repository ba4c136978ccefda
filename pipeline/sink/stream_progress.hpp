#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// How far a running GStreamer pipeline has got: written by its threads, waited for by ours. Waits
/// have no limit as long as something moves.
class StreamProgress {
 public:
  explicit StreamProgress(std::chrono::milliseconds patience) : patience_(patience) {}

  void frame_queued();
  void frame_taken();
  void data_arrived();
  void ended();
  /// The first failure counts; what follows is its consequence.
  void failed_with(std::string text);

  /// Until fewer than `capacity` frames are queued. Fails with the pipeline, or if it has ended.
  [[nodiscard]] Result<void> wait_for_room(std::size_t capacity);

  /// Until the stream's end has come through.
  [[nodiscard]] Result<void> wait_for_end();

  /// Whether and how the pipeline has failed so far.
  [[nodiscard]] Result<void> state() const;

 private:
  template <typename Condition>
  Result<void> wait_until(Condition is_met);
  [[nodiscard]] Result<void> state_locked() const;

  const std::chrono::milliseconds patience_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t queued_ = 0;
  std::uint64_t steps_ = 0;
  bool has_ended_ = false;
  std::optional<std::string> failure_;
};

}  // namespace gimbal

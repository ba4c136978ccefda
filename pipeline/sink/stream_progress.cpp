#include "pipeline/sink/stream_progress.hpp"

#include <fmt/format.h>

#include <utility>

namespace gimbal {

void StreamProgress::frame_queued() {
  const std::lock_guard lock(mutex_);
  ++queued_;
}

void StreamProgress::frame_taken() {
  const std::lock_guard lock(mutex_);
  --queued_;
  ++steps_;
  changed_.notify_all();
}

void StreamProgress::data_arrived() {
  const std::lock_guard lock(mutex_);
  ++steps_;
  changed_.notify_all();
}

void StreamProgress::ended() {
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  changed_.notify_all();
}

void StreamProgress::failed_with(std::string text) {
  const std::lock_guard lock(mutex_);
  if (!failure_) {
    failure_ = std::move(text);
  }
  changed_.notify_all();
}

Result<void> StreamProgress::wait_for_room(std::size_t capacity) {
  auto waited = wait_until([&] { return queued_ < capacity || has_ended_; });
  const std::lock_guard lock(mutex_);
  if (waited && has_ended_) {
    return failed("the pipeline ended before the pictures did");
  }
  return waited;
}

Result<void> StreamProgress::wait_for_end() {
  return wait_until([&] { return has_ended_; });
}

Result<void> StreamProgress::state() const {
  const std::lock_guard lock(mutex_);
  return state_locked();
}

Result<void> StreamProgress::state_locked() const {
  if (failure_) {
    return failed(*failure_);
  }
  return {};
}

template <typename Condition>
Result<void> StreamProgress::wait_until(Condition is_met) {
  std::unique_lock lock(mutex_);
  while (!failure_ && !is_met()) {
    const std::uint64_t steps_before = steps_;
    const bool has_moved = changed_.wait_for(lock, patience_, [&] {
      return failure_.has_value() || is_met() || steps_ != steps_before;
    });
    if (!has_moved) {
      return failed(fmt::format("the pipeline took nothing for {} s",
                                std::chrono::duration<double>(patience_).count()));
    }
  }
  return state_locked();
}

}  // namespace gimbal

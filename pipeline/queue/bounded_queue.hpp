#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace gimbal {

/// What happens to an item that finds the queue full.
enum class WhenFull : std::uint8_t {
  wait,         ///< the giver waits: nothing is lost
  drop_oldest,  ///< the newest wins, and what goes is counted
};

/// Hands items from one thread to another, in order, in bounded memory.
template <typename T, WhenFull when_full>
class BoundedQueue {
 public:
  /// `capacity`: at least 1.
  explicit BoundedQueue(std::size_t capacity) : capacity_(capacity) {}

  /// False once the queue is closed; the item is gone then.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    if constexpr (when_full == WhenFull::wait) {
      has_changed_.wait(lock, [this] { return is_closed_ || items_.size() < capacity_; });
    }
    if (is_closed_) return false;
    if (items_.size() == capacity_) {
      items_.pop_front();
      ++dropped_;
    }
    items_.push_back(std::move(item));
    has_changed_.notify_all();
    return true;
  }

  /// Waits until an item would find room, or the queue is closed.
  void wait_for_room() {
    std::unique_lock lock(mutex_);
    has_changed_.wait(lock, [this] { return is_closed_ || items_.size() < capacity_; });
  }

  /// Waits for the next item; nothing once the queue is closed and empty.
  [[nodiscard]] std::optional<T> pop() {
    std::unique_lock lock(mutex_);
    has_changed_.wait(lock, [this] { return is_closed_ || !items_.empty(); });
    return take(lock);
  }

  /// Waits no longer than that for the next item.
  [[nodiscard]] std::optional<T> pop_within(std::chrono::nanoseconds patience) {
    std::unique_lock lock(mutex_);
    has_changed_.wait_for(lock, patience, [this] { return is_closed_ || !items_.empty(); });
    return take(lock);
  }

  /// Closed, and nothing is left.
  [[nodiscard]] bool is_at_end() const {
    const std::lock_guard lock(mutex_);
    return is_closed_ && items_.empty();
  }

  /// Nothing more comes: what is held can still be taken.
  void close() {
    const std::lock_guard lock(mutex_);
    is_closed_ = true;
    has_changed_.notify_all();
  }

  [[nodiscard]] std::uint64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

  [[nodiscard]] std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return items_.size();
  }

 private:
  /// To be called with the lock held.
  std::optional<T> take(const std::unique_lock<std::mutex>&) {
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    has_changed_.notify_all();
    return item;
  }

  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable has_changed_;
  std::deque<T> items_;
  std::uint64_t dropped_ = 0;
  bool is_closed_ = false;
};

}  // namespace gimbal

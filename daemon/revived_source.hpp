#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "daemon/journal.hpp"
#include "drivers/camera_source.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Whether a source delivers, for people to read.
struct SourceStatus {
  std::string obstacle;  ///< why nothing comes; empty if all is well
  std::uint64_t restarts = 0;
  std::uint64_t lost = 0;                 ///< taken by the device, never seen here
  std::vector<std::string> remarks = {};  ///< what the source says of how it runs
};

/// Nothing comes at present; the source is being brought back.
struct SourceLost {};
/// A recording is over, or the source was stopped.
struct SourceEnd {};

/// Reads a camera or an IMU, and starts it again when it fails, after pauses that grow. One thread
/// starts and reads; `stop` and `status` may come from others.
template <typename Source, typename Item>
class RevivedSource {
 public:
  using Reading = std::variant<Item, SourceLost, SourceEnd>;

  /// `name`: as the log calls it.
  RevivedSource(std::string name, std::unique_ptr<Source> source)
      : name_(std::move(name)), source_(std::move(source)) {}

  /// Fails where the source does: what never ran is not waited for.
  [[nodiscard]] Result<void> start() { return source_->start(); }

  /// Of a camera; see there.
  void ask_for(PictureForm form) { source_->ask_for(form); }

  /// Waits for the next item, or for the source to come back.
  [[nodiscard]] Reading read() {
    if (is_lost_ && !bring_back()) return SourceEnd{};
    auto item = source_->read();
    if (!item) return lose(item.error());
    if (!*item) {
      tell_remarks();
      return SourceEnd{};
    }
    note_item();
    note_remarks();
    return **std::move(item);
  }

  /// A source that is being started may not know yet what it has to stop: it is told again.
  void stop() {
    std::unique_lock lock(mutex_);
    is_stopped_ = true;
    do {
      stopped_.notify_all();
      lock.unlock();
      source_->stop();
      lock.lock();
    } while (!stopped_.wait_for(lock, kStopAgain, [this] { return !is_starting_; }));
  }

  [[nodiscard]] SourceStatus status() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }

 private:
  static constexpr std::chrono::milliseconds kFirstPause{250};
  static constexpr std::chrono::milliseconds kLongestPause{8000};
  static constexpr std::chrono::milliseconds kStopAgain{50};
  static constexpr std::chrono::seconds kRemarksLook{1};
  static constexpr std::chrono::seconds kRemarksTold{30};

  Reading lose(const Error& error) {
    const std::lock_guard lock(mutex_);
    if (is_stopped_) return SourceEnd{};
    is_lost_ = true;
    pause_ = kFirstPause;
    status_.obstacle = error.message;
    lost_before_ += source_->lost();
    log_line(LogLevel::error, fmt::format("{}: {}; trying to bring it back", name_, error.message),
             {name_, {}});
    return SourceLost{};
  }

  /// False if the source was stopped meanwhile.
  bool bring_back() {
    while (wait()) {
      source_->stop();
      const auto started = source_->start();
      const std::lock_guard lock(mutex_);
      is_starting_ = false;
      stopped_.notify_all();
      if (started) {
        is_lost_ = false;
        ++status_.restarts;
        return !is_stopped_;
      }
      status_.obstacle = started.error().message;
    }
    return false;
  }

  /// Whether to start now: not if the source was stopped meanwhile.
  bool wait() {
    std::unique_lock lock(mutex_);
    stopped_.wait_for(lock, pause_, [this] { return is_stopped_; });
    pause_ = std::min(2 * pause_, kLongestPause);
    is_starting_ = !is_stopped_;
    return is_starting_;
  }

  /// A source is well again once something comes, not when it claims to have started.
  void note_item() {
    const std::lock_guard lock(mutex_);
    status_.lost = lost_before_ + source_->lost();
    if (status_.obstacle.empty()) return;
    status_.obstacle.clear();
    log_line(LogLevel::info, name_ + ": it is back", {name_, {}});
  }

  /// Asked now and then, since a remark's numbers may grow with every item; told more rarely still.
  void note_remarks() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_look_) return;
    next_look_ = now + kRemarksLook;
    if (now >= next_telling_ && source_->remarks() != told_) {
      tell_remarks();
      next_telling_ = now + kRemarksTold;
    }
    const std::lock_guard lock(mutex_);
    status_.remarks = source_->remarks();
  }

  void tell_remarks() {
    std::vector<std::string> remarks = source_->remarks();
    for (const std::string& remark : remarks) {
      if (std::ranges::find(told_, remark) == told_.end()) {
        log_line(LogLevel::warning, remark, {name_, {}});
      }
    }
    told_ = std::move(remarks);
  }

  std::string name_;
  std::unique_ptr<Source> source_;
  bool is_lost_ = false;           // read and written by the reading thread alone
  std::uint64_t lost_before_ = 0;  // of earlier starts
  std::chrono::milliseconds pause_ = kFirstPause;
  std::vector<std::string> told_;  // remarks
  std::chrono::steady_clock::time_point next_look_;
  std::chrono::steady_clock::time_point next_telling_;

  mutable std::mutex mutex_;
  std::condition_variable stopped_;
  bool is_stopped_ = false;
  bool is_starting_ = false;
  SourceStatus status_;
};

}  // namespace gimbal

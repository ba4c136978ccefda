#pragma once

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <ctime>

namespace gimbal {

/// Ends a wait in poll(2) from another thread, and stays set until it is cleared.
class StopEvent {
 public:
  StopEvent() : fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
  StopEvent(const StopEvent&) = delete;
  StopEvent& operator=(const StopEvent&) = delete;
  ~StopEvent() { close(fd_); }

  /// From any thread.
  void set() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = write(fd_, &one, sizeof one);  // fails only if long set
  }

  void clear() {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got = ::read(fd_, &count, sizeof count);  // fails only if not set
  }

  [[nodiscard]] bool is_set() const { return wait_for({}); }

  /// Waits; true if it was set before the time was over.
  [[nodiscard]] bool wait_for(std::chrono::nanoseconds time) const {
    const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time);
    const timespec timeout{.tv_sec = whole.count(), .tv_nsec = (time - whole).count()};
    pollfd waiting{.fd = fd_, .events = POLLIN, .revents = 0};
    return ppoll(&waiting, 1, &timeout, nullptr) > 0;
  }

  /// To be polled for POLLIN together with a device.
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

}  // namespace gimbal

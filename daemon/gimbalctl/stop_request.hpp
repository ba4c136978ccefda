#pragma once

#include <csignal>

namespace gimbal {

/// Ctrl-C and SIGTERM as a wish to be asked for, so that what was begun can be ended properly. From
/// construction on; threads that are begun later leave the signals alone too.
class StopRequest {
 public:
  StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  ~StopRequest();

  /// Once for each signal.
  [[nodiscard]] bool came() const;

 private:
  sigset_t signals_{};
  sigset_t before_{};
};

}  // namespace gimbal

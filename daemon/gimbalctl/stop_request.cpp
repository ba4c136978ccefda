#include "daemon/gimbalctl/stop_request.hpp"

#include <ctime>

namespace gimbal {

StopRequest::StopRequest() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGHUP);  // the terminal is gone
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

StopRequest::~StopRequest() {
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

bool StopRequest::came() const {
  const timespec at_once{};
  return sigtimedwait(&signals_, nullptr, &at_once) > 0;
}

}  // namespace gimbal

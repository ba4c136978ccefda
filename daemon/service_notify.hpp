#pragma once

#include <string>

namespace gimbal {

/// Tells the service manager (sd_notify(3)); without one, nothing happens.
void notify_service(const std::string& state);

}  // namespace gimbal

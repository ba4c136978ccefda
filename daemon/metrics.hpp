#pragma once

#include <string>

#include "daemon/supervisor.hpp"

namespace gimbal {

/// What Prometheus reads (text format 0.0.4): names begin with gimbald_, units are SI.
[[nodiscard]] std::string metrics_text(const Supervisor& daemon);

}  // namespace gimbal

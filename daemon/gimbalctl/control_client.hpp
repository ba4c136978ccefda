#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "daemon/control_address.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

/// Which daemon is asked.
struct DaemonAddress {
  std::filesystem::path socket;   ///< a Unix socket ...
  std::optional<TcpControl> tcp;  ///< ... unless this is given
};

/// Sends one request and returns the answer's body. Fails with what the daemon says is wrong, or
/// with why it cannot be reached.
[[nodiscard]] Result<std::string> ask_daemon(const DaemonAddress& daemon, const std::string& method,
                                             const std::string& path, const std::string& body);

}  // namespace gimbal

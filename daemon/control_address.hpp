#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace gimbal {

/// Where requests by TCP are taken, and the word that they have to bring.
struct TcpControl {
  std::string address = "127.0.0.1";
  int port = 0;
  std::string token;

  bool operator==(const TcpControl&) const = default;
};

/// How a running daemon can be asked. By default on a Unix socket alone.
struct ControlSettings {
  /// Empty for none; unset for the usual place, whose lack is no failure.
  std::optional<std::filesystem::path> socket;
  std::optional<TcpControl> tcp;

  bool operator==(const ControlSettings&) const = default;
};

/// Where the daemon listens if it is not told: in the folder that the service manager gives it
/// ($RUNTIME_DIRECTORY), else /run/gimbald for root, else the user's own
/// ($XDG_RUNTIME_DIR/gimbald). Empty if there is no such folder.
[[nodiscard]] std::filesystem::path usual_control_socket();

/// Where a client looks if it is not told: /run/gimbald if a socket is there, else the user's own.
[[nodiscard]] std::filesystem::path usual_socket_to_ask();

}  // namespace gimbal

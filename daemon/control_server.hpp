#pragma once

#include <functional>
#include <memory>
#include <string>

#include "daemon/control_address.hpp"
#include "daemon/control_api.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

using ControlHandler = std::function<ControlAnswer(
    const std::string& method, const std::string& path, const std::string& body)>;

/// Takes requests by HTTP/1.1 on a Unix socket (mode 0660, of the group gimbald if there is one)
/// and, if it is configured, by TCP with `Authorization: Bearer TOKEN`. Requests are small and
/// quick, or refused.
class ControlServer {
 public:
  /// Takes the places to listen at, and answers by `handler` on threads of its own. A socket that
  /// nobody listens on any more is replaced; one that another process listens on is bad_input.
  [[nodiscard]] static Result<std::unique_ptr<ControlServer>> start(const ControlSettings& settings,
                                                                    ControlHandler handler);

  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;
  ~ControlServer();

  /// Of TCP; 0 if there is none. Another than was configured if that was 0.
  [[nodiscard]] int tcp_port() const;

 private:
  class Listener;

  ControlServer();

  std::unique_ptr<Listener> on_socket_;
  std::unique_ptr<Listener> on_tcp_;
};

}  // namespace gimbal

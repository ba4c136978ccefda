#include "daemon/gimbalctl/control_client.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <httplib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>
#include <nlohmann/json.hpp>

namespace gimbal {
namespace {

constexpr int kConnectPatience_s = 10;
/// A recording begins and ends with what is safe on the disk, and a card may take its time.
constexpr int kAnswerPatience_s = 60;
constexpr int kOk = 200;
constexpr int kServerError = 500;

std::string name_of_group(gid_t id) {
  const group* const found = ::getgrgid(id);
  return found != nullptr ? found->gr_name : std::to_string(id);
}

/// Why nothing answers at a socket, and what to do.
std::string obstacle_at(const std::filesystem::path& socket) {
  struct stat status {};
  if (::stat(socket.c_str(), &status) != 0) {
    return fmt::format("{}: no daemon listens here; is gimbald running (systemctl status gimbald)?",
                       socket.string());
  }
  if (::access(socket.c_str(), W_OK) != 0) {
    return fmt::format("{}: permission denied; it is for the group {} (usermod -aG {} {})",
                       socket.string(), name_of_group(status.st_gid), name_of_group(status.st_gid),
                       "USER, then log in again");
  }
  return fmt::format("{}: nobody answers; has gimbald been stopped?", socket.string());
}

std::string obstacle(const DaemonAddress& daemon) {
  if (!daemon.tcp) return obstacle_at(daemon.socket);
  return fmt::format("{}:{}: nobody answers; is gimbald running, with [control] listen?",
                     daemon.tcp->address, daemon.tcp->port);
}

std::unique_ptr<httplib::Client> connect(const DaemonAddress& daemon) {
  if (!daemon.tcp) {
    auto client = std::make_unique<httplib::Client>(daemon.socket.string());
    client->set_address_family(AF_UNIX);
    client->set_default_headers({{"Host", "localhost"}});
    return client;
  }
  auto client = std::make_unique<httplib::Client>(daemon.tcp->address, daemon.tcp->port);
  client->set_default_headers({{"Authorization", "Bearer " + daemon.tcp->token}});
  return client;
}

/// The line that the daemon wrote, or the body as it is.
std::string reason_in(const httplib::Response& response) {
  const auto json = nlohmann::json::parse(response.body, nullptr, false);
  if (json.is_object() && json.contains("error") && json["error"].is_string()) {
    return json["error"].get<std::string>();
  }
  return fmt::format("the daemon answers with status {}", response.status);
}

}  // namespace

Result<std::string> ask_daemon(const DaemonAddress& daemon, const std::string& method,
                               const std::string& path, const std::string& body) {
  const auto client = connect(daemon);
  client->set_connection_timeout(kConnectPatience_s);
  client->set_read_timeout(kAnswerPatience_s);
  const auto response =
      method == "GET" ? client->Get(path) : client->Post(path, body, "application/json");
  if (response.error() == httplib::Error::Read) {
    return failed("the daemon took the question and gave no answer; see journalctl -u gimbald");
  }
  if (!response) return bad_input(obstacle(daemon));
  if (response->status == kOk) return response->body;
  if (response->status >= kServerError) return failed(reason_in(*response));
  return bad_input(reason_in(*response));
}

}  // namespace gimbal

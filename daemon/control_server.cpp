#include "daemon/control_server.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <httplib.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "daemon/journal.hpp"

namespace gimbal {
namespace {

constexpr std::size_t kLargestBody = 65536;
/// With a client that stops in the middle of a word: an end waits for it, and so does who comes
/// next.
constexpr int kPatience_s = 1;
constexpr std::size_t kThreads = 8;
constexpr const char* kGroup = "gimbald";
constexpr int kUnauthorized = 401;

/// Takes the same time wherever they differ, so that nobody can feel their way.
bool are_equal(const std::string& given, const std::string& token) {
  if (given.size() != token.size()) return false;
  int difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i) difference |= given[i] ^ token[i];
  return difference == 0;
}

/// Without SO_REUSEPORT, the library's own choice, by which a second daemon would take half of the
/// requests.
void reuse_address(int descriptor) {
  const int yes = 1;
  ::setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

/// What the library can read to its end and knows a way for.
bool is_usual(const httplib::Request& request) {
  const bool has_body =
      request.has_header("Content-Length") || request.has_header("Transfer-Encoding");
  return request.method == "GET" || (request.method == "POST" && has_body);
}

bool somebody_listens(const std::filesystem::path& socket) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  socket.string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return false;
  const bool answers =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  ::close(probe);
  return answers;
}

Result<void> make_way(const std::filesystem::path& socket) {
  if (socket.string().size() >= sizeof(sockaddr_un::sun_path)) {
    return bad_input(
        fmt::format("control socket {}: longer than a socket's name may be ({} letters)",
                    socket.string(), sizeof(sockaddr_un::sun_path) - 1));
  }
  std::error_code error;
  const auto status = std::filesystem::symlink_status(socket, error);
  if (!std::filesystem::exists(status)) {
    std::filesystem::create_directories(socket.parent_path(), error);
    return {};
  }
  if (!std::filesystem::is_socket(status)) {
    return bad_input(fmt::format("control socket {}: something else is there", socket.string()));
  }
  if (somebody_listens(socket)) {
    return bad_input(
        fmt::format("control socket {}: another gimbald listens there", socket.string()));
  }
  std::filesystem::remove(socket, error);
  return {};
}

/// For the owner and the group alone.
void restrict(const std::filesystem::path& socket) {
  constexpr mode_t kOwnerAndGroup = 0660;
  const group* const ours = ::getgrnam(kGroup);
  if (ours != nullptr && ours->gr_gid != ::getegid() &&
      ::chown(socket.c_str(), static_cast<uid_t>(-1), ours->gr_gid) != 0) {
    log_line(LogLevel::warning,
             fmt::format("control socket {}: cannot be given to the group {}: {}", socket.string(),
                         kGroup, std::strerror(errno)),
             {"control", {}});
  }
  ::chmod(socket.c_str(), kOwnerAndGroup);
}

}  // namespace

/// One place that is listened at.
class ControlServer::Listener {
 public:
  explicit Listener(ControlHandler handler) : handler_(std::move(handler)) {
    server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
    server_.set_payload_max_length(kLargestBody);
    server_.set_read_timeout(kPatience_s);
    server_.set_write_timeout(kPatience_s);
    server_.set_keep_alive_timeout(kPatience_s);
    const auto respond = [this](const httplib::Request& request, httplib::Response& response) {
      answer(request, response);
    };
    server_.set_socket_options(reuse_address);
    // The library waits for the body of a POST that has none, and knows no other methods.
    server_.set_pre_routing_handler([respond](const auto& request, auto& response) {
      if (is_usual(request)) return httplib::Server::HandlerResponse::Unhandled;
      response.set_header("Connection", "close");
      respond(request, response);
      return httplib::Server::HandlerResponse::Handled;
    });
    server_.Get(".*", respond);
    server_.Post(".*", respond);
  }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  ~Listener() {
    if (thread_.joinable()) {
      server_.stop();
      thread_.join();
    }
    std::error_code ignored;
    if (!socket_.empty()) std::filesystem::remove(socket_, ignored);
  }

  Result<void> bind_socket(const std::filesystem::path& socket) {
    if (auto free = make_way(socket); !free) return free;
    server_.set_address_family(AF_UNIX);
    constexpr int kAnyPort = 80;          // has no meaning here
    const mode_t before = ::umask(0117);  // never open to others, not even for a moment
    const bool is_bound = server_.bind_to_port(socket.string(), kAnyPort);
    const int reason = errno;
    ::umask(before);
    if (!is_bound) {
      return bad_input(
          fmt::format("control socket {}: {}", socket.string(), std::strerror(reason)));
    }
    socket_ = socket;
    restrict(socket);
    return {};
  }

  Result<void> bind_tcp(const TcpControl& tcp) {
    token_ = tcp.token;
    port_ = tcp.port;
    const bool is_bound = tcp.port == 0 ? (port_ = server_.bind_to_any_port(tcp.address)) > 0
                                        : server_.bind_to_port(tcp.address, tcp.port);
    if (is_bound) return {};
    return bad_input(
        fmt::format("control at {}:{}: {}", tcp.address, tcp.port, std::strerror(errno)));
  }

  /// Returns when requests are taken: a server that does not run yet cannot be stopped.
  void listen() {
    thread_ = std::thread([this] {
      server_.listen_after_bind();
      has_ended_ = true;
    });
    while (!server_.is_running() && !has_ended_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  [[nodiscard]] int port() const { return port_; }

 private:
  void answer(const httplib::Request& request, httplib::Response& response) {
    if (!token_.empty() &&
        !are_equal(request.get_header_value("Authorization"), "Bearer " + token_)) {
      response.status = kUnauthorized;
      response.set_content("{\"error\": \"the token is missing or wrong\"}\n", "application/json");
      return;
    }
    const ControlAnswer answer = handler_(request.method, request.path, request.body);
    response.status = answer.status;
    response.set_content(answer.body, answer.content_type);
  }

  ControlHandler handler_;
  httplib::Server server_;
  std::filesystem::path socket_;
  std::string token_;
  int port_ = 0;
  std::atomic<bool> has_ended_ = false;
  std::thread thread_;
};

ControlServer::ControlServer() = default;
ControlServer::~ControlServer() = default;

int ControlServer::tcp_port() const {
  return on_tcp_ ? on_tcp_->port() : 0;
}

Result<std::unique_ptr<ControlServer>> ControlServer::start(const ControlSettings& settings,
                                                            ControlHandler handler) {
  std::unique_ptr<ControlServer> server(new ControlServer);
  const std::filesystem::path socket = settings.socket.value_or(usual_control_socket());
  if (!socket.empty()) {
    server->on_socket_ = std::make_unique<Listener>(handler);
    const auto bound = server->on_socket_->bind_socket(socket);
    if (!bound && settings.socket) return tl::unexpected(bound.error());
    if (bound) {
      server->on_socket_->listen();
    } else {
      log_line(LogLevel::warning, bound.error().message + "; going on without", {"control", {}});
      server->on_socket_.reset();
    }
  }
  if (settings.tcp) {
    server->on_tcp_ = std::make_unique<Listener>(std::move(handler));
    if (auto bound = server->on_tcp_->bind_tcp(*settings.tcp); !bound) {
      return tl::unexpected(bound.error());
    }
    server->on_tcp_->listen();
  }
  return server;
}

}  // namespace gimbal

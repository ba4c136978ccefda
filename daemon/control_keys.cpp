#include "daemon/control_keys.hpp"

#include <charconv>
#include <fstream>
#include <string>

namespace gimbal {
namespace {

constexpr int kLargestPort = 65535;

/// The first line.
std::optional<std::string> read_token(const std::string& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line) || line.empty()) return std::nullopt;
  return line;
}

}  // namespace

std::optional<TcpControl> parse_tcp_control(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0) return std::nullopt;
  TcpControl tcp;
  tcp.address = text.substr(0, colon);
  if (tcp.address.front() == '[' && tcp.address.back() == ']') {
    tcp.address = tcp.address.substr(1, tcp.address.size() - 2);
  }
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data() + colon + 1, end, tcp.port);
  const bool is_port =
      parsed.ec == std::errc() && parsed.ptr == end && tcp.port >= 0 && tcp.port <= kLargestPort;
  return is_port ? std::optional(tcp) : std::nullopt;
}

void read_control(TomlTable& table, ControlSettings& settings) {
  if (const auto socket = table.text("socket")) settings.socket = *socket;
  const auto token = table.text("token");
  const auto token_file = table.text("token_file");
  const auto listen = table.text("listen");
  if (!listen) {
    if (token || token_file) {
      table.refuse(token ? "token" : "token_file", "is for TCP: give listen = \"ADDRESS:PORT\"");
    }
    return;
  }
  auto tcp = parse_tcp_control(*listen);
  if (!tcp) {
    table.refuse("listen", "is not ADDRESS:PORT, such as \"127.0.0.1:8410\"");
    return;
  }
  if (token) tcp->token = *token;
  if (token_file) {
    const auto read = read_token(*token_file);
    if (!read) table.refuse("token_file", "cannot be read, or has no first line");
    tcp->token = read.value_or("");
  }
  if (tcp->token.empty()) {
    table.refuse("listen",
                 "needs token_file = \"FILE\" beside it: whoever reaches the port must know it");
  }
  settings.tcp = *std::move(tcp);
}

}  // namespace gimbal

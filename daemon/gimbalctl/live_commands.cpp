#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "daemon/control_keys.hpp"
#include "daemon/gimbalctl/commands.hpp"
#include "daemon/gimbalctl/control_client.hpp"
#include "daemon/gimbalctl/live_status.hpp"

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

struct Arguments {
  std::string socket;
  std::string tcp;
  std::string token_file;
  bool as_json = false;
  std::vector<std::string> settings;  ///< KEY=VALUE
};

Result<std::string> token_of(const Arguments& arguments) {
  if (arguments.token_file.empty()) {
    const char* const token = std::getenv("GIMBALD_TOKEN");
    return std::string(token != nullptr ? token : "");
  }
  std::ifstream file(arguments.token_file);
  std::string token;
  if (!std::getline(file, token)) {
    return bad_input(fmt::format("{}: the token cannot be read", arguments.token_file));
  }
  return token;
}

Result<DaemonAddress> address_of(const Arguments& arguments) {
  DaemonAddress daemon;
  if (arguments.tcp.empty()) {
    daemon.socket = arguments.socket;
    if (daemon.socket.empty()) daemon.socket = usual_socket_to_ask();
    return daemon;
  }
  daemon.tcp = parse_tcp_control(arguments.tcp);
  if (!daemon.tcp) {
    return bad_input(
        fmt::format("--tcp {}: write ADDRESS:PORT, such as 127.0.0.1:8410", arguments.tcp));
  }
  auto token = token_of(arguments);
  if (!token) return tl::unexpected(token.error());
  daemon.tcp->token = *std::move(token);
  return daemon;
}

Result<std::string> ask(const Arguments& arguments, const char* method, const char* path,
                        const std::string& body = "") {
  const auto daemon = address_of(arguments);
  if (!daemon) return tl::unexpected(daemon.error());
  return ask_daemon(*daemon, method, path, body);
}

Result<Json> as_json(const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_object()) return json;
  return failed("what the daemon answers is not understood; is it another version?");
}

/// Numbers stay numbers; all else is text.
Result<Json> settings_of(const Arguments& arguments) {
  Json settings = Json::object();
  for (const std::string& setting : arguments.settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      return bad_input(fmt::format("set {}: write KEY=VALUE, such as amount=0.5", setting));
    }
    const std::string value = setting.substr(equals + 1);
    const Json number = Json::parse(value, nullptr, false);
    settings[setting.substr(0, equals)] = number.is_number() ? number : Json(value);
  }
  return settings;
}

Result<void> show_status(const Arguments& arguments) {
  const auto text = ask(arguments, "GET", "/status");
  if (!text) return tl::unexpected(text.error());
  if (arguments.as_json) {
    fmt::print("{}", *text);
    return {};
  }
  const auto status = as_json(*text);
  if (!status) return tl::unexpected(status.error());
  fmt::print("{}", status_for_people(*status));
  return {};
}

Result<void> show_metrics(const Arguments& arguments) {
  const auto text = ask(arguments, "GET", "/metrics");
  if (!text) return tl::unexpected(text.error());
  fmt::print("{}", *text);
  return {};
}

Result<void> set(const Arguments& arguments) {
  const auto settings = settings_of(arguments);
  if (!settings) return tl::unexpected(settings.error());
  const auto text = ask(arguments, "POST", "/set", settings->dump());
  if (!text) return tl::unexpected(text.error());
  const auto in_force = as_json(*text);
  if (!in_force) return tl::unexpected(in_force.error());
  fmt::print("{}", settings_for_people(*in_force));
  return {};
}

Result<void> record(const Arguments& arguments, const char* path) {
  const auto text = ask(arguments, "POST", path);
  if (!text) return tl::unexpected(text.error());
  const auto recording = as_json(*text);
  if (!recording) return tl::unexpected(recording.error());
  fmt::print("{}", recording_line(*recording));
  return {};
}

Result<void> reload(const Arguments& arguments) {
  const auto text = ask(arguments, "POST", "/reload");
  if (!text) return tl::unexpected(text.error());
  const auto report = as_json(*text);
  if (!report) return tl::unexpected(report.error());
  fmt::print("{}", reload_for_people(*report));
  return {};
}

CLI::App* add_command(CLI::App& app, const char* name, const char* help,
                      const std::shared_ptr<Arguments>& arguments, CommandOutcome& outcome,
                      Result<void> (*run)(const Arguments&)) {
  CLI::App* command = app.add_subcommand(name, help);
  CLI::Option* const socket = command->add_option("--socket", arguments->socket,
                                                  "The daemon's Unix socket [the usual places]");
  CLI::Option* const tcp =
      command
          ->add_option("--tcp", arguments->tcp, "ADDRESS:PORT instead, as [control] listen has it")
          ->excludes(socket);
  command
      ->add_option("--token-file", arguments->token_file,
                   "With the token in its first line [the environment's GIMBALD_TOKEN]")
      ->needs(tcp);
  command->callback([arguments, &outcome, run] { outcome = run(*arguments); });
  return command;
}

}  // namespace

void add_live_commands(CLI::App& app, CommandOutcome& outcome) {
  const auto arguments = std::make_shared<Arguments>();
  add_command(app, "status", "Show how the running daemon is doing", arguments, outcome,
              show_status)
      ->add_flag("--json", arguments->as_json, "For programs");
  add_command(app, "set", "Change settings of the running daemon, until the next reload", arguments,
              outcome, set)
      ->add_option("settings", arguments->settings,
                   "KEY=VALUE: amount, path, latency_frames, zoom, zoom_limits, zoom_speed_per_s, "
                   "border, horizon or horizon_range_deg")
      ->required();
  add_command(app, "reload", "Have the running daemon read its configuration again", arguments,
              outcome, reload);
  CLI::App* const take = app.add_subcommand(
      "record", "Record what the running daemon sees, as a session that can be stabilized later");
  take->require_subcommand(1);
  add_command(*take, "start", "Begin a session folder", arguments, outcome,
              [](const Arguments& a) { return record(a, "/record/start"); });
  add_command(*take, "stop", "End it properly", arguments, outcome,
              [](const Arguments& a) { return record(a, "/record/stop"); });
  add_command(app, "metrics", "Show the running daemon's metrics, as Prometheus reads them",
              arguments, outcome, show_metrics);
}

}  // namespace gimbal

#include "daemon/control_api.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "daemon/journal.hpp"
#include "daemon/metrics.hpp"
#include "daemon/status_json.hpp"

namespace gimbal {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kBadRequest = 400;
constexpr int kNotFound = 404;
constexpr int kMethodNotAllowed = 405;
constexpr int kServerError = 500;

ControlAnswer as_answer(const Json& json) {
  // Names of files need not be UTF-8: what is not is replaced rather than refused.
  return {.body = json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"};
}

ControlAnswer refusal(int status, const std::string& reason) {
  ControlAnswer answer = as_answer({{"error", reason}});
  answer.status = status;
  return answer;
}

ControlAnswer refusal(const Error& error) {
  return refusal(error.kind == Error::Kind::bad_input ? kBadRequest : kServerError, error.message);
}

/// A JSON object of plain values as TOML, so that one reader checks both.
Result<std::string> as_toml(const std::string& body) {
  const Json json = Json::parse(body, nullptr, false);
  if (!json.is_object() || json.empty()) {
    return bad_input("the body must be a JSON object with a setting, such as {\"amount\": 0.5}");
  }
  std::string toml;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_number() && !value.is_string()) {
      return bad_input(fmt::format("{}: a number or a text is expected", key));
    }
    toml += fmt::format("{} = {}\n", Json(key).dump(), value.dump());
  }
  return toml;
}

}  // namespace

ControlAnswer ControlApi::answer(const std::string& method, const std::string& path,
                                 const std::string& body) {
  const bool is_get = path == "/status" || path == "/metrics";
  const bool is_record = path == "/record/start" || path == "/record/stop";
  const bool is_post = path == "/set" || path == "/reload" || is_record;
  if (!is_get && !is_post) {
    return refusal(kNotFound,
                   "there is /status, /metrics, /set, /reload, /record/start and /record/stop");
  }
  const char* const wanted = is_get ? "GET" : "POST";
  if (method != wanted) return refusal(kMethodNotAllowed, fmt::format("{} takes {}", path, wanted));
  if (path == "/status") return as_answer(status_as_json(daemon_));
  if (path == "/metrics") {
    return {.content_type = "text/plain; version=0.0.4", .body = metrics_text(daemon_)};
  }
  if (is_record) return record(path == "/record/start" ? Take::start : Take::stop);
  return path == "/set" ? set(body) : reload();
}

ControlAnswer ControlApi::set(const std::string& body) {
  const auto done =
      as_toml(body).and_then([this](const std::string& toml) { return daemon_.set(toml); });
  if (!done) return refusal(done.error());
  const Json settings = live_settings_as_json(daemon_.settings());
  log_line(LogLevel::info, "set: " + settings.dump(), {"control", {}});
  return as_answer(settings);
}

ControlAnswer ControlApi::record(Take take) {
  Recorder& recorder = daemon_.recorder();
  if (take == Take::start) {
    if (const auto begun = recorder.start(); !begun) return refusal(begun.error());
    return as_answer(recording_as_json(recorder.status()));
  }
  const auto ended = recorder.stop();
  return ended ? as_answer(recording_as_json(*ended)) : refusal(ended.error());
}

ControlAnswer ControlApi::reload() {
  const auto report = daemon_.reload();
  if (!report) return refusal(report.error());
  return as_answer({{"applied", report->applied}, {"at_next_start", report->at_next_start}});
}

}  // namespace gimbal

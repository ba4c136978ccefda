#pragma once

#include <string>

#include "daemon/supervisor.hpp"

namespace gimbal {

/// An answer as HTTP carries it.
struct ControlAnswer {
  int status = 200;
  std::string content_type = "application/json";
  std::string body;
};

/// What a running daemon can be asked, apart from how the question comes. Any thread may ask.
///
///     GET  /status   see status_as_json
///     GET  /metrics  see metrics_text
///     POST /set      {"amount": 0.5, ...}: what may change live; the settings in force afterwards
///     POST /reload   {"applied": [...], "at_next_start": [...]}
///     POST /record/start, /record/stop   the recording, as in /status
///
/// Where something is wrong the body is {"error": "one line"}.
class ControlApi {
 public:
  explicit ControlApi(Supervisor& daemon) : daemon_(daemon) {}

  [[nodiscard]] ControlAnswer answer(const std::string& method, const std::string& path,
                                     const std::string& body);

 private:
  [[nodiscard]] ControlAnswer set(const std::string& body);
  [[nodiscard]] ControlAnswer reload();
  enum class Take { start, stop };
  [[nodiscard]] ControlAnswer record(Take take);

  Supervisor& daemon_;
};

}  // namespace gimbal

#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace gimbal {

// The daemon's answers (see status_as_json) as lines for a person to read. What is missing in an
// answer is left out.

[[nodiscard]] std::string status_for_people(const nlohmann::ordered_json& status);
[[nodiscard]] std::string settings_for_people(const nlohmann::ordered_json& settings);
[[nodiscard]] std::string recording_line(const nlohmann::ordered_json& recording);
[[nodiscard]] std::string reload_for_people(const nlohmann::ordered_json& report);

}  // namespace gimbal

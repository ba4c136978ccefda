#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "drivers/replay/session.hpp"

namespace gimbal {

/// What a session.toml says, before any log is read.
struct SessionToml {
  /// With everything that session.toml holds; no samples, video or folder.
  Session session;
  /// What a number in accel.csv has to be multiplied by to get specific force in m/s².
  double accel_to_specific_force_m_s2 = 1.0;
  std::vector<std::string> warnings;
};

/// Reads a session.toml. Errors name the file, line, key, value and what is allowed; keys that are
/// not known become warnings.
[[nodiscard]] Result<SessionToml> read_session_toml(const std::filesystem::path& path);

/// The text of a session.toml for this session, its logs being in m/s² and specific force.
[[nodiscard]] std::string format_session_toml(const Session& session);

}  // namespace gimbal

#include "daemon/gimbalctl/calibration_profile.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <iterator>
#include <system_error>

#include "daemon/durable_file.hpp"
#include "drivers/replay/session_toml.hpp"

namespace gimbal {

std::string own_toml(const Session& session) {
  std::ifstream file(session.folder / "session.toml");
  if (!file) return format_session_toml(session);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string by_whom(std::string_view command, std::string_view source) {
  return fmt::format("by gimbalctl {} on {:%Y-%m-%d} to {}", command,
                     fmt::gmtime(std::time(nullptr)), source);
}

std::string by_whom(std::string_view command, const Session& session) {
  std::error_code ignored;
  return by_whom(command,
                 std::filesystem::weakly_canonical(session.folder, ignored).filename().string());
}

void add_profile_options(CLI::App& command, ProfileFile& profile, const std::string& help) {
  CLI::Option* const write = command.add_option("--write", profile.path, help);
  command
      .add_flag_callback(
          "--overwrite", [&profile] { profile.existing = ExistingFile::replaced; },
          "Replace that file if it is there")
      ->needs(write);
}

Result<void> check_profile(const ProfileFile& profile) {
  const auto& [path, existing] = profile;
  if (path.empty()) return {};
  std::error_code ignored;
  if (existing == ExistingFile::kept && std::filesystem::exists(path, ignored)) {
    return bad_input(path.string() + ": is there already; give another name, or --overwrite");
  }
  const std::filesystem::path folder = path.parent_path();
  if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
    return bad_input(path.string() + ": there is no folder " + folder.string());
  }
  return {};
}

Result<void> write_calibration_profile(std::string_view known_toml, const FittedCalibration& fitted,
                                       std::string_view comments, const ProfileFile& profile) {
  if (profile.path.empty()) return {};
  if (auto can_write = check_profile(profile); !can_write) return can_write;
  const auto text = recalibrated_toml(known_toml, fitted);
  if (!text) return tl::unexpected(text.error());
  return replace_file(profile.path, std::string(comments) + *text);
}

}  // namespace gimbal

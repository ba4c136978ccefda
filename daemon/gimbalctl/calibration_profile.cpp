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
namespace {

Result<void> check_file(const std::filesystem::path& path, ExistingFile existing) {
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

}  // namespace

std::string own_toml(const Session& session) {
  std::ifstream file(session.folder / "session.toml");
  if (!file) return format_session_toml(session);
  return {std::istreambuf_iterator<char>(file), {}};
}

Result<std::string> replaced_toml(const ResultFiles& files) {
  std::ifstream file(files.profile);
  if (files.profile.empty() || !file) return "";
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!recalibrated_toml(text, {})) {
    return bad_input(files.profile.string() +
                     ": is no TOML, so that what it says could not be kept; give another name");
  }
  return text;
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

void add_plot_option(CLI::App& command, ResultFiles& files, const std::string& help) {
  command.add_option("--plot", files.plot, help);
}

void add_profile_option(CLI::App& command, ResultFiles& files, const std::string& help) {
  command.add_option("--write", files.profile, help);
}

void add_overwrite_flag(CLI::App& command, ResultFiles& files) {
  command.add_flag_callback(
      "--overwrite", [&files] { files.existing = ExistingFile::replaced; },
      "Replace what is there of the files that are to be written");
}

Result<void> check_files(const ResultFiles& files) {
  return check_file(files.profile, files.existing).and_then([&] {
    return check_file(files.plot, files.existing);
  });
}

Result<void> write_calibration_profile(std::string_view known_toml, const FittedCalibration& fitted,
                                       std::string_view comments, const ResultFiles& files) {
  if (files.profile.empty()) return {};
  if (auto can_write = check_file(files.profile, files.existing); !can_write) return can_write;
  const auto text = recalibrated_toml(known_toml, fitted);
  if (!text) return tl::unexpected(text.error());
  return replace_file(files.profile, std::string(comments) + *text);
}

}  // namespace gimbal

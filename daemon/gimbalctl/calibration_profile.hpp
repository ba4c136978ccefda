#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "drivers/replay/recalibrated_toml.hpp"
#include "drivers/replay/session.hpp"
#include "pipeline/sample/result.hpp"

namespace gimbal {

enum class ExistingFile : std::uint8_t { kept, replaced };

/// Where what was found is written and drawn; empty: nowhere.
struct ResultFiles {
  std::filesystem::path profile;
  std::filesystem::path plot;
  ExistingFile existing = ExistingFile::kept;
};

/// --plot, --write and --overwrite; `files` live as long as the command.
void add_plot_option(CLI::App& command, ResultFiles& files, const std::string& help);
void add_profile_option(CLI::App& command, ResultFiles& files, const std::string& help);
void add_overwrite_flag(CLI::App& command, ResultFiles& files);

/// "by gimbalctl COMMAND on DATE to SOURCE", for the head of a profile.
[[nodiscard]] std::string by_whom(std::string_view command, std::string_view source);
[[nodiscard]] std::string by_whom(std::string_view command, const Session& session);

/// The recording's session.toml; one in its place where it has none.
[[nodiscard]] std::string own_toml(const Session& session);

/// Of a calibration without a recording: the profile that is replaced, or nothing where none is
/// there. bad_input if it is no TOML, so that it could not be kept.
[[nodiscard]] Result<std::string> replaced_toml(const ResultFiles& files);

/// Before what takes long, or cannot be done again: bad_input if a file is there and is to be kept,
/// or has no folder.
[[nodiscard]] Result<void> check_files(const ResultFiles& files);

/// Writes what was found, if it is wanted, as a session.toml, which a session folder and the
/// daemon's `camera.calibration` take: what was known before, with the fitted values in it, under
/// comments that say when they were fitted and how well they are known. Fails as the check above.
[[nodiscard]] Result<void> write_calibration_profile(std::string_view known_toml,
                                                     const FittedCalibration& fitted,
                                                     std::string_view comments,
                                                     const ResultFiles& files);

}  // namespace gimbal

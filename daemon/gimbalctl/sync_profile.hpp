#pragma once

#include <cstdint>
#include <filesystem>

#include "drivers/replay/session.hpp"
#include "pipeline/sample/result.hpp"
#include "pipeline/sync/synchronization.hpp"

namespace gimbal {

enum class ExistingFile : std::uint8_t { kept, replaced };

/// Writes what was found as a session.toml, which a session folder and the daemon's
/// `camera.calibration` take: what the recording's own says, with the fitted values in it, and in
/// comments when they were fitted and how well they are known. bad_input if the result is not to be
/// trusted, or the file is there and is to be kept.
[[nodiscard]] Result<void> write_sync_profile(const Session& session, const Synchronization& found,
                                              const std::filesystem::path& path,
                                              ExistingFile existing);

}  // namespace gimbal

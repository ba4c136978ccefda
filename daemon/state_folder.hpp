#pragma once

#include <filesystem>

namespace gimbal {

/// What outlives a run lies in the folder that the service manager keeps for us ($STATE_DIRECTORY),
/// else in /var/lib/gimbald for root, else in gimbald below $XDG_DATA_HOME or ~/.local/share.
[[nodiscard]] std::filesystem::path state_folder();

}  // namespace gimbal

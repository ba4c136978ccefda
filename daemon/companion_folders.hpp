#pragma once

#include <filesystem>
#include <vector>

namespace gimbal {

/// Where this program's companions may lie: beside it, as they are built, and in the folder of what
/// nobody runs by hand, as they are installed. None where the system does not say where the program
/// is: anything of a companion's name would do then that lies in the current folder.
[[nodiscard]] std::vector<std::filesystem::path> companion_folders();

}  // namespace gimbal

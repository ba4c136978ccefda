#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pipeline/sample/result.hpp"

namespace gimbal {

/// A file or folder that the program brings along, such as {"cameras", "ipod-touch-4-720p.toml"}:
/// it lies in share/gimbald next to where the program is installed or built. bad_input if it is not
/// there, with the names that are.
[[nodiscard]] Result<std::filesystem::path> find_data_file(std::string_view kind,
                                                           const std::string& name);

}  // namespace gimbal

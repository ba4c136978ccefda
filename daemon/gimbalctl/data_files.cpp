#include "daemon/gimbalctl/data_files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <vector>

namespace gimbal {
namespace {

/// From bin/gimbalctl it is one folder up, from a build tree's daemon/gimbalctl/gimbalctl two.
std::optional<std::filesystem::path> data_folder() {
  std::error_code error;
  std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", error);
  for (int above = 0; above < 3 && folder.has_parent_path(); ++above) {
    folder = folder.parent_path();
    if (std::filesystem::is_directory(folder / "share/gimbald", error)) {
      return folder / "share/gimbald";
    }
  }
  return std::nullopt;
}

std::string names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return list;
}

}  // namespace

Result<std::filesystem::path> find_data_file(std::string_view kind, const std::string& name) {
  const std::optional<std::filesystem::path> folder = data_folder();
  if (!folder) {
    return bad_input(fmt::format(
        "{}: no share/gimbald near the program; install it again or give a path", name));
  }
  std::error_code error;
  if (std::filesystem::exists(*folder / kind / name, error)) return *folder / kind / name;
  return bad_input(fmt::format("{}: no such file, and not among the {} in {}: {}", name, kind,
                               (*folder / kind).string(), names_in(*folder / kind)));
}

}  // namespace gimbal

#include "daemon/state_folder.hpp"

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace gimbal {

std::filesystem::path state_folder() {
  if (const char* const given = std::getenv("STATE_DIRECTORY")) {
    const std::string folders = given;  // several are parted by colons; the first is ours
    return folders.substr(0, folders.find(':'));
  }
  if (::geteuid() == 0) return "/var/lib/gimbald";
  if (const char* const data = std::getenv("XDG_DATA_HOME")) {
    return std::filesystem::path(data) / "gimbald";
  }
  const char* const home = std::getenv("HOME");
  return std::filesystem::path(home != nullptr ? home : "/tmp") / ".local/share/gimbald";
}

}  // namespace gimbal

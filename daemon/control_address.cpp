#include "daemon/control_address.hpp"

#include <unistd.h>

#include <cstdlib>
#include <system_error>

namespace gimbal {
namespace {

constexpr const char* kSystemFolder = "/run/gimbald";
constexpr const char* kSocketName = "control.sock";

std::filesystem::path folder_of_user() {
  const char* const runtime = std::getenv("XDG_RUNTIME_DIR");
  return runtime != nullptr ? std::filesystem::path(runtime) / "gimbald" : std::filesystem::path();
}

}  // namespace

std::filesystem::path usual_control_socket() {
  std::filesystem::path folder;
  if (const char* const given = std::getenv("RUNTIME_DIRECTORY")) {
    const std::string folders = given;  // several are parted by colons; the first is ours
    folder = folders.substr(0, folders.find(':'));
  } else {
    folder = ::geteuid() == 0 ? std::filesystem::path(kSystemFolder) : folder_of_user();
  }
  return folder.empty() ? folder : folder / kSocketName;
}

std::filesystem::path usual_socket_to_ask() {
  const std::filesystem::path system = std::filesystem::path(kSystemFolder) / kSocketName;
  std::error_code ignored;
  const bool is_there = std::filesystem::exists(system, ignored);
  const std::filesystem::path user = folder_of_user();
  return is_there || user.empty() ? system : user / kSocketName;
}

}  // namespace gimbal

#include "drivers/v4l2/node_access.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace gimbal {
namespace {

std::string name_of_group(gid_t id) {
  std::array<char, 4096> text{};
  group entry{};
  group* found = nullptr;
  if (::getgrgid_r(id, &entry, text.data(), text.size(), &found) == 0 && found != nullptr) {
    return entry.gr_name;
  }
  return std::to_string(id);
}

std::string advice_on_permission(const std::string& path) {
  struct stat node {};
  if (::stat(path.c_str(), &node) != 0) return "no permission: its folder may not be searched";
  const bool group_may = (node.st_mode & S_IRGRP) != 0 && (node.st_mode & S_IWGRP) != 0;
  if (!group_may) {
    return fmt::format(
        "no permission: its mode {:03o} lets no group read and write; give it one with a udev rule",
        node.st_mode & 0777U);
  }
  const std::string group = name_of_group(node.st_gid);
  return fmt::format(
      "no permission: add the user to group {0} (usermod -aG {0} USER) and log in again", group);
}

}  // namespace

std::string why_not_open(const std::string& path, int error) {
  switch (error) {
    case EACCES:
      return advice_on_permission(path);
    case EPERM:
      return "not allowed: the service's DeviceAllow= has to name it";
    case ENOENT:
      return "no such device; `gimbalctl devices` lists those that are there";
    case ENODEV:
    case ENXIO:
      return "the device is gone";
    case EBUSY:
      return "busy: another program has it";
    default:
      return "cannot be opened: " + std::generic_category().message(error);
  }
}

}  // namespace gimbal

#include "daemon/companion_folders.hpp"

#include <system_error>

namespace gimbal {

std::vector<std::filesystem::path> companion_folders() {
  std::error_code ignored;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  if (here.empty()) return {};
  return {here, here / GIMBALD_LIBEXEC_FROM_BIN};
}

}  // namespace gimbal

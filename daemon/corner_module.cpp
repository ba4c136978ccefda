#include "daemon/corner_module.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <string>
#include <system_error>

#include "daemon/companion_folders.hpp"

namespace gimbal {
namespace {

constexpr const char* kModule = "gimbald-corners.so";
constexpr const char* kFunction = "gimbald_corner_follower";

}  // namespace

Result<const CornerFollower*> load_corner_follower() {
  namespace fs = std::filesystem;
  std::error_code ignored;
  for (const fs::path& folder : companion_folders()) {
    const fs::path file = folder / kModule;
    if (!fs::exists(file, ignored)) continue;
    void* const module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) return bad_input(std::string("cannot be loaded: ") + ::dlerror());
    const auto get =
        reinterpret_cast<decltype(&gimbald_corner_follower)>(::dlsym(module, kFunction));
    if (get == nullptr) return bad_input(file.string() + ": is not of this gimbald");
    return get();
  }
  return bad_input(std::string(kModule) +
                   " is not installed; it comes with the package gimbald-calibration, or with a "
                   "build that has OpenCV");
}

}  // namespace gimbal

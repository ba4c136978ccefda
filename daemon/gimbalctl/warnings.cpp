#include "daemon/gimbalctl/warnings.hpp"

#include <fmt/core.h>

namespace gimbal {

void print_warnings(std::span<const std::string> warnings) {
  for (const std::string& warning : warnings) {
    fmt::print(stderr, "gimbalctl: warning: {}\n", warning);
  }
}

}  // namespace gimbal

#include "daemon/gimbalctl/warnings.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace gimbal {

void print_warnings(std::span<const std::string> warnings) {
  for (const std::string& warning : warnings) {
    // Unlike fmt::print this does not throw: a warning that nobody reads must not end the work.
    static_cast<void>(std::fputs(fmt::format("gimbalctl: warning: {}\n", warning).c_str(), stderr));
  }
}

}  // namespace gimbal

#pragma once

#include <span>
#include <string>

namespace gimbal {

/// A line each on standard error.
void print_warnings(std::span<const std::string> warnings);

}  // namespace gimbal

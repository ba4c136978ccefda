#pragma once

#include <string>
#include <string_view>

namespace gimbal {

/// What a file had, in quotes for a message of one line: bytes outside printable ASCII escaped,
/// long text cut.
[[nodiscard]] std::string in_quotes(std::string_view text);

}  // namespace gimbal

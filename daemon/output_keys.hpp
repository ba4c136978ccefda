#pragma once

#include <optional>

#include "daemon/output_target.hpp"
#include "drivers/replay/toml_reader.hpp"

namespace gimbal {

/// One table [[output]]. Nothing if it is refused; the fault is kept in the table.
[[nodiscard]] std::optional<OutputSettings> read_output(TomlTable& table);

}  // namespace gimbal

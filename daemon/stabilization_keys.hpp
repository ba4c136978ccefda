#pragma once

#include "daemon/stabilization.hpp"
#include "drivers/replay/toml_reader.hpp"

namespace gimbal {

// Keys of the table [stabilization]. Faults are kept in the table; a key that is not there changes
// nothing.

/// Those that may change while pictures are drawn: amount, path, latency, zoom, its limits and
/// speed, border and horizon.
void read_live_stabilization(TomlTable& table, StabilizationSettings& settings);

/// All of them.
void read_stabilization(TomlTable& table, StabilizationSettings& settings);

/// Fails if a table was read with a fault, or holds a key that nobody asked for.
[[nodiscard]] Result<void> verdict(const TomlTable& table);

}  // namespace gimbal

#pragma once

#include "daemon/control_address.hpp"
#include "drivers/replay/toml_reader.hpp"

namespace gimbal {

/// The table [control]. Faults are kept in the table.
void read_control(TomlTable& table, ControlSettings& settings);

/// ADDRESS:PORT, with an IPv6 address in brackets; nothing if it is not that.
[[nodiscard]] std::optional<TcpControl> parse_tcp_control(const std::string& text);

}  // namespace gimbal

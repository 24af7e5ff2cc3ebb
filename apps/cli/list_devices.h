#pragma once

#include <string>

namespace pertev {

/// Lists the devices that --device names, a line each, with what tells them apart; the CPU is the last one.
std::string list_devices();

} // namespace pertev

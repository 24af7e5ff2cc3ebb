#pragma once

#include <string>

namespace pertev {

/// Lists the devices of --device, one per line, with distinguishing properties; the CPU comes last.
std::string list_devices();

} // namespace pertev

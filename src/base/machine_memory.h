#pragma once

// How much memory there is, for what refuses to begin what would not fit.

#include <cstddef>

namespace pertev {

/// Memory that this machine has, bytes; SIZE_MAX where it does not say.
std::size_t machine_memory_bytes();

} // namespace pertev

#pragma once

// Formats byte counts for people.

#include <cstdint>

namespace pertev {

inline double mebibytes(uint64_t bytes) { return static_cast<double>(bytes) / 0x1p20; }
inline double gibibytes(uint64_t bytes) { return static_cast<double>(bytes) / 0x1p30; }

} // namespace pertev

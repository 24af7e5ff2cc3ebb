#pragma once

// Processor time, for tests that hold a bound on work: wall time would depend on what else the machine does.

#include <ctime>

namespace pertev::test {

/// Seconds that all threads of this process have computed so far.
inline double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

} // namespace pertev::test

#pragma once

// Processor time for tests that limit work. Wall time would depend on the machine's load.

#include <ctime>

namespace pertev::test {

/// Returns the processor seconds of all threads of this process so far.
inline double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Returns a time limit of `seconds` scaled for this build, because sanitizers slow code down several times.
constexpr double allowed_seconds(double seconds) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return 10 * seconds;
#else
    return seconds;
#endif
}

} // namespace pertev::test

#include "base/machine_memory.h"

#include <unistd.h>

#include <cstdint>

namespace pertev {

std::size_t machine_memory_bytes() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), bytes = ::sysconf(_SC_PAGESIZE);
    return pages > 0 && bytes > 0 ? static_cast<std::size_t>(pages) * static_cast<std::size_t>(bytes) : SIZE_MAX;
}

} // namespace pertev

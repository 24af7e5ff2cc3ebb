#pragma once

// Large pages for memory that is read at random: an array of some megabytes lies in thousands of pages of 4 KB, more
// than a CPU keeps the places of, so that most cache misses cost a look at the page tables as well. Linux alone:
// elsewhere, and where the system has none to give, nothing happens.

#include <cstddef>
#include <span>

namespace pertev {

/// Moves what fills whole pages of 2 MB into such pages, if it can. The bytes stay where they are, unchanged; any
/// thread may read them meanwhile.
void use_huge_pages(std::span<const std::byte> bytes);

} // namespace pertev

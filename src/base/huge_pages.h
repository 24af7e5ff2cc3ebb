#pragma once

// Huge pages for randomly accessed memory: an array of some megabytes occupies thousands of 4 KB pages, more than a
// CPU's TLB holds, so that most cache misses also need a page-table traversal. Linux only: elsewhere, and if the system
// has none available, nothing happens.

#include <cstddef>
#include <span>

#include "base/sink.h"

namespace pertev {

/// Moves the part of `bytes` that fills whole pages of 2 MB into such pages, if possible. The bytes keep their
/// addresses and values; any thread may read them meanwhile. `sink` may end it.
void use_huge_pages(std::span<const std::byte> bytes, Sink& sink = nobody());

} // namespace pertev

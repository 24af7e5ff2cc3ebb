#pragma once

// Huge pages for large arrays: an array of some megabytes occupies thousands of 4 KB pages, more than a CPU's TLB
// holds, so that most cache misses also need a page-table traversal, and the first use of each page costs a page fault.
// Linux only: elsewhere, and if the system has none available, nothing happens.

#include <cstddef>
#include <span>
#include <vector>

#include "base/sink.h"

namespace pertev {

/// Moves the part of `bytes` that fills whole pages of 2 MB into such pages, if possible. The bytes keep their
/// addresses and values; any thread may read them meanwhile. `sink` may end it.
void use_huge_pages(std::span<const std::byte> bytes, Sink& sink = nobody());

/// Lets the part of `bytes` that fills whole pages of 2 MB, and was not used yet, get huge pages at its first use.
void expect_huge_pages(std::span<const std::byte> bytes);

/// Reserves memory of an empty array on huge pages.
template <class T>
void reserve_on_huge_pages(std::vector<T>& array, std::size_t count) {
    array.reserve(count);
    expect_huge_pages({reinterpret_cast<const std::byte*>(array.data()), array.capacity() * sizeof(T)});
}

/// Returns an array of `count` elements on huge pages.
template <class T>
std::vector<T> array_on_huge_pages(std::size_t count) {
    std::vector<T> array;
    reserve_on_huge_pages(array, count);
    array.resize(count);
    return array;
}

} // namespace pertev

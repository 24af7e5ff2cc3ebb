#pragma once

// Places the arrays of a view one after the other in one piece of memory, on a device or in a thread of the CPU.

#include <cstddef>

namespace pertev {

/// Calls list(place), and `list` calls place(pointer, count) for each array. That points the array into `memory`, at a
/// multiple of 16 bytes. The pointer is null if `memory` is null or the array is empty. Returns the bytes of all
/// arrays.
template <class List>
std::size_t lay_out_arrays(std::byte* memory, const List& list) {
    std::size_t bytes = 0;
    list([&]<class T>(T*& array, std::size_t count) {
        array = memory != nullptr && count > 0 ? reinterpret_cast<T*>(memory + bytes) : nullptr;
        bytes += (count * sizeof(T) + 15) / 16 * 16;
    });
    return bytes;
}

} // namespace pertev

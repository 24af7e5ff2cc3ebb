#pragma once

// A vector whose resize() leaves new elements of trivial types uninitialised, so that threads that fill them share the
// first touch of the memory: the system's clearing of 64 MB takes one thread 30 ms.

#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace pertev {

template <class T>
struct RawAllocator : std::allocator<T> {
    template <class U>
    struct rebind {
        using other = RawAllocator<U>;
    };
    template <class U>
    void construct(U* at) noexcept {
        ::new (static_cast<void*>(at)) U;
    }
    template <class U, class... Arguments>
    void construct(U* at, Arguments&&... arguments) {
        ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
    }
};

template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

} // namespace pertev

#pragma once

// Arrays of one part of a scene (its geometry, its lights, ...) in device memory: a list that computes their total
// size and copies them into one buffer, each at a multiple of 256 bytes.

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "device/buffer.h"

namespace pertev {

class PartArrays {
public:
    /// Adds an array: upload() will set `target` to the copy of `values`, or null if empty. Both must stay in place
    /// until then. `values` may contain targets of arrays added before, because they are copied after all pointers are
    /// set.
    template <class T>
    void add(std::span<const T> values, const T*& target) {
        static_assert(std::is_trivially_copyable_v<T>);
        arrays_.push_back({std::as_bytes(values), &target});
    }
    template <class T>
    void add(const std::vector<T>& values, const T*& target) {
        add(std::span<const T>(values), target);
    }

    /// Size of the buffer that upload() needs, bytes.
    std::size_t bytes() const;
    /// Reuses `buffer` if it is large enough; otherwise frees it and allocates another. `name` appears in the message
    /// of Error(OutOfMemory), after which the part is empty.
    void upload(Queue& queue, Buffer<std::byte>& buffer, const std::string& name) const;

private:
    struct Array {
        std::span<const std::byte> values;
        void* target; // const T**
    };
    void set_pointers(const std::byte* base) const;

    std::vector<Array> arrays_;
};

} // namespace pertev

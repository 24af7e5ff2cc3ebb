#pragma once

// The arrays that one part of a scene (its geometry, its lights, ...) has in a device's memory: one list that tells how
// many bytes they take and copies them into one buffer, each at a multiple of 256 bytes.

#include <cstddef>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "device/buffer.h"

namespace pertev {

class PartArrays {
public:
    /// upload() will let `target` point to the copy of `values`, null where there are none. Both stay where they are
    /// until then. `values` may hold targets of arrays added before: they are copied after all pointers are known.
    template <class T>
    void add(std::span<const T> values, const T*& target) {
        static_assert(std::is_trivially_copyable_v<T>);
        arrays_.push_back({std::as_bytes(values), &target});
    }
    template <class T>
    void add(const std::vector<T>& values, const T*& target) {
        add(std::span<const T>(values), target);
    }

    /// Of the buffer.
    std::size_t bytes() const;
    /// `buffer` is kept when it is large enough, else there is a new one, once the old one is gone: `name` stands in
    /// the message of Error(OutOfMemory), after which the part is empty.
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

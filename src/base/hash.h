#pragma once

// Content hashes (XXH3, 128 bits) of pictures, for the one-picture law, and of geometry, for the structure cache.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace pertev {

struct Hash128 {
    uint64_t high = 0, low = 0;
    bool operator==(const Hash128&) const = default;
    /// Text of 32 lower-case hexadecimal digits.
    std::string hex() const;
};

/// Hashes bytes in pieces; the result does not depend on the partition.
class Hasher {
public:
    Hasher();
    ~Hasher();
    Hasher(const Hasher&) = delete;
    Hasher& operator=(const Hasher&) = delete;

    void add(std::span<const std::byte> bytes);
    template <class T>
    void add_values(std::span<const T> values) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
        add(std::as_bytes(values));
    }
    template <class T>
    void add_value(const T& value) {
        add_values(std::span<const T>(&value, 1));
    }
    Hash128 result() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace pertev

#pragma once

// Packs a plane: one byte of each of many elements that are alike. A plane that is constant takes two bytes; another
// one is deflated if that is shorter.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace pertev {

/// Appends the packed form of `plane`, which is not empty, to `packed`.
void pack_plane(std::span<const std::byte> plane, std::vector<std::byte>& packed);
/// Takes a packed plane from the front of `packed` and fills `plane` with it. Returns false for anything that
/// pack_plane does not write for as many bytes; both are then of no use.
bool take_plane(std::span<const std::byte>& packed, std::span<std::byte> plane);

inline void append(std::span<const std::byte> bytes, std::vector<std::byte>& to) {
    to.insert(to.end(), bytes.begin(), bytes.end());
}
/// Takes a number from the front of `packed`; returns false if that is too short.
inline bool take_size(std::span<const std::byte>& packed, uint32_t& size) {
    if (packed.size() < sizeof size) return false;
    std::memcpy(&size, packed.data(), sizeof size);
    packed = packed.subspan(sizeof size);
    return true;
}

} // namespace pertev

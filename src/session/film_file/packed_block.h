#pragma once

// Packs a block of a film's target: elements of equal size, such as the sums of a pixel, of neighbouring pixels.

#include <cstddef>
#include <span>
#include <vector>

namespace pertev {

/// Returns the packed form of `elements`, each of `stride` bytes. It is the same with any number of threads.
std::vector<std::byte> pack_block(std::span<const std::byte> elements, std::size_t stride);

/// Restores `elements`. Returns false for anything that pack_block does not write for as many; `elements` are then of
/// no use.
bool unpack_block(std::span<const std::byte> packed, std::size_t stride, std::span<std::byte> elements);

/// Fewest bytes that a packed block takes.
std::size_t least_packed_bytes(std::size_t stride);

} // namespace pertev

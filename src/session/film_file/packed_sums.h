#pragma once

// Packs sums of one channel of neighbouring pixels. Between the highest and the lowest bit that is set, a sum of
// samples is noise, which nothing shortens: those bits are kept as they are. Where the two bits lie differs little from
// pixel to pixel, and less from the channel before: their numbers are packed as planes.

#include <optional>
#include <span>
#include <vector>

#include "render/fixed_sum.h"

namespace pertev {

/// Returns the packed sums; nothing if one of them takes all 128 bits. `before` are the sums of the channel before at
/// the same pixels; empty: there is none, or it does not help.
std::optional<std::vector<std::byte>> pack_sums(std::span<const FixedSum> sums, std::span<const FixedSum> before);

/// Restores `sums` with the same `before`. Returns false for anything that pack_sums does not write; `sums` are then of
/// no use.
bool unpack_sums(std::span<const std::byte>& packed, std::span<const FixedSum> before, std::span<FixedSum> sums);

} // namespace pertev

#pragma once

// What the properties of a PLY vertex mean, by their names: the format gives none, and programs differ.

#include <cstddef>
#include <string_view>

namespace pertev {

enum PlySlot : std::size_t { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRed, kGreen, kBlue, kAlpha, kU, kV, kSlots };

/// kSlots for a name that is not read.
std::size_t ply_slot_of(std::string_view name);

} // namespace pertev

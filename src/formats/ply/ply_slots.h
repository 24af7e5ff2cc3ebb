#pragma once

// Meanings of vertex properties by their names, which PLY does not define and programs use differently.

#include <cstddef>
#include <string_view>

namespace pertev {

enum PlySlot : std::size_t { kX, kY, kZ, kNormalX, kNormalY, kNormalZ, kRed, kGreen, kBlue, kAlpha, kU, kV, kSlots };

/// Returns the slot of a property by its name; kSlots for a name that is not read.
std::size_t ply_slot_of(std::string_view name);

} // namespace pertev

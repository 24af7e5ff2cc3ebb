#pragma once

// The solids of glass or water that hold a point, and what device code knows of solids that lie in each other. Each
// has a rank, above 0; where solids overlap, the greatest rank fills the point (device_scene/nest_solids.h).
//
// Source: Schmidt, Budge, "Simple Nested Dielectrics in Ray Traced Images", Journal of Graphics Tools 7(2), 2002.

#include <cstdint>

#include "base/host_device.h"
#include "math/float4.h"
#include "math/scalar.h"

namespace pertev {

/// A set of up to four ranks; a fifth one replaces the least. A solid is entered once, however often its surface is
/// reported, so that a list recovers from a surface that a ray missed.
struct InteriorList {
    uint64_t ranks = 0; // 16 bits each, the greatest first; 0: none

    HD static InteriorList of_words(Uint2 words) { return {words.x | uint64_t(words.y) << 32}; }
    HD Uint2 words() const { return {static_cast<uint32_t>(ranks), static_cast<uint32_t>(ranks >> 32)}; }

    /// Returns the rank of the solid that fills the point; 0 in a vacuum.
    HD uint32_t top() const { return static_cast<uint32_t>(ranks >> 48); }
    HD bool has(uint32_t rank) const {
        for (int shift = 48; shift >= 0; shift -= 16)
            if (at(shift) == rank) return true;
        return false;
    }
    HD InteriorList with(uint32_t rank) const {
        if (has(rank)) return *this;
        InteriorList list;
        for (int shift = 48; shift >= 0; shift -= 16) {
            const uint32_t present = at(shift);
            list.ranks |= uint64_t(max(present, rank)) << shift;
            rank = min(present, rank);
        }
        return list;
    }
    HD InteriorList without(uint32_t rank) const {
        InteriorList list;
        int to = 48;
        for (int shift = 48; shift >= 0; shift -= 16) {
            const uint32_t present = at(shift);
            if (present == rank) continue;
            list.ranks |= uint64_t(present) << to;
            to -= 16;
        }
        return list;
    }

private:
    HD uint32_t at(int shift) const { return static_cast<uint32_t>(ranks >> shift) & 0xffffu; }
};

struct NestingView {
    const uint16_t* ranks = nullptr;  // [instance_count]; 0: no such solid; null: no solids lie in each other
    const uint32_t* solids = nullptr; // [rank] the instance
    // [light triangles + punctual lights] words of the InteriorList that holds the middle of a light, without the
    // light's own instance; null unless the scene has media
    const Uint2* of_lights = nullptr;

    HD bool is_there() const { return ranks != nullptr; }
};

} // namespace pertev

#include "formats/ply/ply_slots.h"

namespace pertev {

std::size_t ply_slot_of(std::string_view name) {
    struct Name {
        std::string_view name;
        PlySlot slot;
    };
    static constexpr Name names[] = {
        {"x", kX},
        {"y", kY},
        {"z", kZ},
        {"nx", kNormalX},
        {"ny", kNormalY},
        {"nz", kNormalZ},
        {"red", kRed},
        {"green", kGreen},
        {"blue", kBlue},
        {"alpha", kAlpha},
        {"r", kRed},
        {"g", kGreen},
        {"b", kBlue},
        {"a", kAlpha},
        {"diffuse_red", kRed},
        {"diffuse_green", kGreen},
        {"diffuse_blue", kBlue},
        {"u", kU},
        {"v", kV},
        {"s", kU},
        {"t", kV},
        {"texture_u", kU},
        {"texture_v", kV},
        {"texture_s", kU},
        {"texture_t", kV},
        {"texcoord_u", kU},
        {"texcoord_v", kV},
        {"s0", kU},
        {"t0", kV},
    };
    for (const Name& known : names) {
        if (known.name == name) return known.slot;
    }
    return kSlots;
}

} // namespace pertev

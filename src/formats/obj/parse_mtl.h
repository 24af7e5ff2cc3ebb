#pragma once

// The text of a Wavefront .mtl file as its numbers and names, nothing converted yet. Ramey, Rose, Tyerman, "MTL
// material format", 1995; the PBR keys as Exocortex defined them and Blender writes them. Keys count in any case.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/messages.h"
#include "math/rgb.h"
#include "math/vec2.h"

namespace pertev {

struct MtlTexture {
    std::string name; // as written; empty: there is none
    uint32_t line = 0;
    Vec2 offset = {0, 0}, scale = {1, 1}; // -o, -s; v upwards
    bool clamp = false;
    bool is_linear = false;    // -colorspace linear
    char channel = 'm';        // -imfchan
    float bump_multiplier = 1; // -bm
};

/// What one newmtl says, with the format's value for what it does not say.
struct MtlStatements {
    std::string name;
    uint32_t line = 0; // of newmtl
    std::optional<Rgb> kd;
    Rgb ks = {}, ke = {}, tf = {};
    float illum = 0, ns = 1, ni = 1, pr = 0, pm = 0;
    float d = 1;
    bool has_d = false; // d itself, which outweighs Tr, its complement
    MtlTexture map_kd, map_ke, map_d, map_pr, map_pm, norm, bump;
};

/// In the order of the file. What is left out is a warning with the line. Throws Error(BadInput) that names `file` and
/// the line for a number that is missing, is none or is not finite.
std::vector<MtlStatements> parse_mtl(std::span<const std::byte> bytes, const std::string& file, Messages& messages);

} // namespace pertev

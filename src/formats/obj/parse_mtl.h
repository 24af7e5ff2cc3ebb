#pragma once

// Parses a Wavefront .mtl file to numbers and names without converting them. Ramey, Rose, Tyerman, "MTL material
// format", 1995; the PBR keys as Exocortex defined them and Blender writes them. Keys are case-insensitive.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/sink.h"
#include "math/rgb.h"
#include "math/vec2.h"

namespace pertev {

struct MtlTexture {
    std::string name; // unresolved; empty: none
    uint32_t line = 0;
    Vec2 offset = {0, 0}, scale = {1, 1}; // -o, -s; v upwards
    bool clamp = false;
    bool is_linear = false;    // -colorspace linear
    char channel = 'm';        // -imfchan
    float bump_multiplier = 1; // -bm
};

/// Statements of one newmtl, with the format's defaults.
struct MtlStatements {
    std::string name;
    uint32_t line = 0; // line of newmtl
    std::optional<Rgb> kd;
    Rgb ks = {}, ke = {}, tf = {};
    float illum = 0, ns = 1, ni = 0, pr = 0, pm = 0, ps = 0, pc = 0, pcr = 0;
    float aniso = 0, anisor = 0; // anisor in turns; ni is 0 if it is not given
    float d = 1;
    bool has_d = false; // d itself was given, which overrides Tr, its complement
    MtlTexture map_kd, map_ke, map_d, map_pr, map_pm, map_ps, map_pc, map_pcr, norm, bump;
};

/// Returns materials in the order of the file. Anything left out gives a warning with the line. Throws
/// Error(BadInput) that names `file` and the line for a number that is missing, invalid or not finite.
std::vector<MtlStatements> parse_mtl(std::span<const std::byte> bytes, const std::string& file, Sink& sink);

} // namespace pertev

#pragma once

// Lamps of a scene set to stated amounts of light, in the units in which lamps are sold and measured. A lamp keeps its
// colour.

#include <span>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace pertev {

enum class LampUnit : uint8_t {
    Watt,    // radiant flux, 683 lm each
    Lumen,   // luminous flux
    Candela, // luminous intensity: of a spot in its middle, of a flat lamp along its normal
    Lux,     // of a directional light: illuminance of a surface that faces it
    Nit,     // cd/m2, luminance: of a surface, of an even environment
};

struct LampStrength {
    std::string name; // as scene/names.h has it, of lamps, lights and the environment
    double value = 0; // at least 0
    LampUnit unit = LampUnit::Lumen;
    std::string text; // as it was asked for
};

/// Of NAME=800lm; W, lm, cd, lx, nits. Throws Error(BadInput), as everything here.
LampStrength parse_lamp(std::string_view text);

/// Sets every lamp of these names, each to all of the amount. Flux of a surface goes out from its faces that emit, as
/// cosines do: pi L A each, L the mean over the surface where the emission has a texture. A material that other objects
/// share is copied for a lamp. Throws for a name that no lamp has, and for a unit that a lamp of this kind cannot have:
/// flux of a lamp that has holes or whose object has no area, candela of one that is not flat, all but nits of an
/// environment. `lumens_per_watt`: photometry.h.
void set_lamps(Scene& scene, std::span<const LampStrength> lamps, double lumens_per_watt);

} // namespace pertev

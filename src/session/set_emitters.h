#pragma once

// Sets emitters of a scene to stated amounts of light, in the units in which lights are sold and measured. An emitter
// keeps its colour.

#include <span>
#include <string>
#include <string_view>

#include "scene/scene.h"

namespace pertev {

enum class EmitterUnit : uint8_t {
    Watt,    // radiant flux, 683 lm each
    Lumen,   // luminous flux
    Candela, // luminous intensity: of a spot along its axis, of a flat emitter along its normal
    Lux,     // illuminance by a directional light on a surface that faces it
    Nit,     // cd/m2, luminance of a surface or of a uniform environment
};

struct EmitterStrength {
    std::string name; // name of an emitter, a light or the environment (scene/names.h)
    double value = 0; // at least 0
    EmitterUnit unit = EmitterUnit::Lumen;
    std::string text; // text of the request
};

/// Parses NAME=800lm; units are W, lm, cd, lx, nits. Throws Error(BadInput), like all functions here.
EmitterStrength parse_emitter(std::string_view text);

/// Sets every emitter with one of these names to the whole amount. Flux of a surface leaves its emissive faces with a
/// cosine distribution: pi L A each, where L is the mean over the surface if the emission has a texture. A material
/// that other objects share is copied. Throws for a name without emitter, and for a unit that this kind of emitter
/// cannot have: flux for an emitter that has holes or no area, candela for one that is not flat, anything but nits
/// for an environment. `lumens_per_watt`: see photometry.h.
void set_emitters(Scene& scene, std::span<const EmitterStrength> emitters, double lumens_per_watt);

} // namespace pertev

#pragma once

// Base colours with which our diffuse surfaces beneath rough dielectric coats reflect as much as those of pbrt and
// Mitsuba.
//
// Both renderers let light in and out through microfacets that scatter once: what one bounce off them loses is lost
// on the way in, on the way out and at each reflection inside, so their rough coats are darker than smooth ones.
// The base of our model gets all that the coat does not reflect (shading/lobes/filmed_lobe.h). The two have different
// shapes over the angle, too; their albedos are made equal under a white sky.

#include "formats/described/surface.h"

namespace pertev::described {

enum class CoatModel { Mitsuba, Pbrt };

/// Numbers with which the base beneath a coat reflects as it does in Mitsuba or pbrt.
struct CoatedBase {
    float factor; // on the colour, if light that the coat sends back in is not dyed again
    float inside; // [0, 1), share of the diffuse light inside that the coat sends back in
};

/// Returns the numbers for the base beneath `coat`, of which ior, roughness, microfacets and the reflection's colour
/// count. Textures of these count as 1, and one of the roughness as a width of 0.1.
///
/// Source: Mitsuba 3's plugin roughplastic, whose base reflects
///   color T(i) T(o) / (n^2 pi (1 - inside)), with `nonlinear` 1 - color inside instead of 1 - inside,
/// T the transmittance of single scattering (Walter et al. 2007) with masking that is separable.
CoatedBase base_of_coat(const Material& coat, CoatModel model);

/// Returns the share of a white sky's light that the dielectric reflection of `coat` lets through to the base and out
/// again in our model. What counts is as in base_of_coat().
float passed_by_reflection(const Material& coat);

/// Sets the colour of a diffuse surface beneath the coat that `surface` has already. `is_dyed`: by each reflection
/// inside, which saturates it.
void set_coated_color(Surface& surface, const TextureValue& color, CoatModel model, bool is_dyed);

} // namespace pertev::described

#pragma once

// Surfaces that the readers of pbrt's and Mitsuba's materials share.

#include "formats/described/surface.h"

namespace pertev::described {

/// Returns a surface of a kind with smooth microfacets of GGX that lose what one bounce loses.
Surface make_surface(MaterialKind kind);

/// Makes a metal of the colour that it reflects at every angle.
void set_mirror(Surface& surface, const TextureValue& color);
/// Makes a thin wall of a dielectric's index. Its two surfaces, between which light bounces, reflect 2 F / (1 + F); the
/// wall has the index of one surface that reflects as much at 0 degrees.
void set_thin_pane(Surface& surface);
/// Multiplies what a thin wall of set_thin_pane() reflects and what it transmits. A colour of the reflection fades
/// towards grazing angles; the transmission is exact at 0 degrees.
void tint_thin_pane(Surface& surface, const TextureValue& reflected, const TextureValue& transmitted);

/// Sets the roughness along u and along v. Of textures one counts for both, that of u if it has one.
void set_roughness(Surface& surface, const TextureValue& u, const TextureValue& v, Curve curve);

/// Gives the coat of `surface` the roughness of a reflection that set_roughness() has set.
void set_coat_roughness(Surface& surface, const Surface& reflection);

/// The share of diffuse light inside a smooth dielectric of this index that its surface reflects back.
float reflected_inside(float ior);

} // namespace pertev::described

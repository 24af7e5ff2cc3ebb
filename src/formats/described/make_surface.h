#pragma once

// Surfaces that the readers of pbrt's and Mitsuba's materials share.

#include <cstddef>
#include <optional>

#include "formats/described/surface.h"

namespace pertev::described {

/// Returns a surface of a kind with smooth microfacets of GGX that lose what one bounce loses.
Surface make_surface(MaterialKind kind);

/// Makes a metal of the colour that it reflects at every angle.
void set_mirror(Surface& surface, const TextureValue& color);
/// Makes a thin wall of a dielectric's index. Its two surfaces, between which light bounces, reflect 2 F / (1 + F); the
/// wall has the index of one surface that reflects as much at 0 degrees.
void set_thin_pane(Surface& surface);

/// Sets the roughness along u and along v. Of textures one counts for both, that of u if it has one.
void set_roughness(Surface& surface, const TextureValue& u, const TextureValue& v, Curve curve);

/// The share of diffuse light inside a smooth dielectric of this index that its surface reflects back.
float reflected_inside(float ior);

struct MixedSurface {
    Surface surface;
    std::optional<std::size_t> left_out; // 0 or 1: of which nothing remains though it has a share
    bool is_by_color = false;            // only the colours are mixed of parts that differ in more
};
/// Says what `is_by_color` means, of a mixture such as "the blendbsdf".
std::string mixed_by_color(const std::string& mixture);
/// Mixes two surfaces: exactly if one is no surface or both are diffuse, else as the one with the larger share.
/// `of_second` is the share of the second one.
MixedSurface mix_surfaces(const Surface& first, const Surface& second, const TextureValue& of_second);

} // namespace pertev::described

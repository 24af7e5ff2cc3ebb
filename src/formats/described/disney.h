#pragma once

// Parts of Disney's principled BSDF, which pbrt-v3 and Mitsuba have alike, as parts of glTF's material.
//
// Source: Burley, "Physically Based Shading at Disney", SIGGRAPH courses 2012; Mitsuba 3's plugins principled and
// principledthin; pbrt-v3's material disney.

#include "formats/described/surface.h"

namespace pertev::described {

/// Makes the dielectric, whose index is set already, reflect as much of a white sky as by Fresnel's equations, times
/// `weight` in [0, 1]. Schlick's reflectance alone is 1 at grazing angles, whatever the index. An index below 1 keeps
/// it.
void set_disney_reflection(Material& material, float weight);

/// Sets the base colour. Disney's reflection lies beside the diffuse light and does not dim it as ours, so the colour
/// is brightened, up to white. Reflection, metal and transmission are set already. `roughness` is the file's, if it has
/// no texture.
void set_disney_color(Surface& surface, const TextureValue& color, float roughness);

/// Sets the coat of `clearcoat` and `gloss` in [0, 1].
void set_disney_coat(Material& material, float clearcoat, float gloss);

/// Sets the sheen of `sheen` in [0, 1], which is much weaker than glTF's.
void set_disney_sheen(Material& material, float sheen);

} // namespace pertev::described

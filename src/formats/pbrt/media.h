#pragma once

// Homogeneous media of pbrt, and those of its subsurface materials.

#include "formats/pbrt/context.h"
#include "formats/pbrt/materials.h"
#include "scene/medium.h"

namespace pertev::pbrt {

/// Reads sigma_a, sigma_s, scale, g and preset, in units of the scene.
MediumParameters read_medium(Parameters& parameters, const Context& context);

/// Reads the medium of a material subsurface or kdsubsurface: by coefficients, by a substance's name, or by the colour
/// that it shows and the mean free path.
MediumParameters read_subsurface_medium(const MaterialSource& source);

} // namespace pertev::pbrt

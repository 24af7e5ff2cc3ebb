#pragma once

// Lights of pbrt. Strengths follow colors.h.

#include <optional>
#include <string>

#include "formats/described/parameters.h"
#include "formats/described/parts.h"
#include "formats/pbrt/context.h"
#include "formats/pbrt/textures.h"
#include "math/double_transform.h"
#include "scene/light.h"

namespace pertev::pbrt {

/// Reads the light of a shape's surface. Returns nothing, with a warning, for a type that is left out.
std::optional<AreaLight> read_area_light(const std::string& type, Parameters& parameters, Textures& textures,
                                         const Context& context);
std::optional<InfiniteLight> read_infinite_light(Parameters& parameters, const DoubleTransform& world_from_light,
                                                 const Context& context);
/// Reads a light that is neither an area nor infinite.
std::optional<Light> read_light(const std::string& type, Parameters& parameters,
                                const DoubleTransform& world_from_light, const Context& context);

} // namespace pertev::pbrt

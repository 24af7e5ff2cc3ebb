#pragma once

// Emitters of Mitsuba. A spot's edge falls off as that of KHR_lights_punctual, which differs from Mitsuba's straight
// line by the angle.

#include <optional>

#include "formats/mitsuba/reading.h"
#include "formats/mitsuba/textures.h"

namespace pertev::mitsuba {

/// Adds an emitter that is no shape's to the parts. One that is left out gives a warning.
void add_emitter(Object& emitter, Reading& reading);
/// Returns the emission of a shape; nothing, with a warning, for a type that is left out.
std::optional<AreaLight> read_area_light(Object& emitter, Textures& textures, Reading& reading);

} // namespace pertev::mitsuba

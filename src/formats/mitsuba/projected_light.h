#pragma once

// Mitsuba's projectors, and its spots, whose intensity falls linearly with the angle between beam_width and
// cutoff_angle and which may project a picture.

#include "formats/mitsuba/reading.h"
#include "scene/light.h"

namespace pertev::mitsuba {

/// Completes a spot by its cone, on top of its intensity and its transform. Returns false, with a warning, if it is
/// left out.
bool set_spot(Object& emitter, const DoubleTransform& to_world, Reading& reading, Light& light);

/// Completes a projector by its picture and its transform. Returns false, with a warning, if it is left out.
bool set_projector(Object& emitter, const DoubleTransform& to_world, Reading& reading, Light& light);

} // namespace pertev::mitsuba

#pragma once

// The emitters sunsky, sun and sky of Mitsuba, by formats/sun_sky/ in place of Hosek's and Wilkie's model.

#include "formats/mitsuba/reading.h"

namespace pertev::mitsuba {

/// The sun's height and its angle from south towards west, radians.
struct SunPosition {
    float height, from_south;
};

/// Returns the sun's place at the time and position of parameters; without any it is that of Mitsuba's default, an
/// afternoon in Tokyo.
/// Source: Preetham, Shirley, Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999, appendix A.6.
SunPosition sun_position_at(Parameters& time, Sink& sink);

/// Sets the sky of an emitter that is a sky or a sun, with a warning that Pertev's model is another one.
void set_sky(Object& emitter, Reading& reading, InfiniteLight& light);

} // namespace pertev::mitsuba

#pragma once

// shade_hit as the CPU's loop calls it: compiled for what a picture's materials are known to be, by numbers that have
// been drawn.

#include "integrators/path/drawn_numbers.h"
#include "integrators/path/shade_hit.h"

namespace pertev {

using ShadeOnHost = bool (*)(const PictureView&, const PathSettings&, const FilmView&, PathState&, const Hit&,
                             const DrawnNumbers&, ShadowRay&, bool& wants_shadow);

/// The one with no more code than picture and film need.
ShadeOnHost shading_for(const PictureView& picture, const FilmView& film);

} // namespace pertev

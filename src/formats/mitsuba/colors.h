#pragma once

// Spectra of Mitsuba's files as linear Rec. 709, as its variants of RGB have them: that of a light is the colour of its
// radiance, others have their colour under D65.

#include <optional>
#include <string_view>

#include "formats/mitsuba/reading.h"
#include "math/rgb.h"

namespace pertev::mitsuba {

enum class ColorUse {
    Reflectance, // in [0, 1]
    Light,       // W/(sr m2) and the like
    Index,       // a complex index, or another number
};

/// Returns the colour of a parameter; nothing, with a warning, if it is unreadable.
std::optional<Rgb> color_of(Object& object, const Parameter& parameter, ColorUse use, Reading& reading);
/// Returns the colour of an object <spectrum type="...">.
std::optional<Rgb> color_of_object(Object& spectrum, ColorUse use, Reading& reading);

/// Returns the colour `name`; `missing` without one or if it is unreadable.
Rgb read_color(Object& object, std::string_view name, ColorUse use, Rgb missing, Reading& reading);

} // namespace pertev::mitsuba

#pragma once

// Spectral parameters as linear Rec. 709: rgb, xyz, blackbody, spectra of wavelengths and values, by name, or from a
// file of pbrt-v3.
//
// pbrt-v4 scales the radiance of a light that is no rgb to luminance 1, whatever its spectrum's values; an rgb (r, g,
// b) is r, g, b times the colour space's white at luminance 1. So both are plain colours here. pbrt-v3 takes values as
// they are.

#include <optional>
#include <string_view>

#include "formats/described/parameters.h"
#include "formats/pbrt/context.h"
#include "formats/spectra/named_spectra.h"
#include "math/rgb.h"

namespace pertev::pbrt {

/// Returns the colour of a light's parameter, not negative; `missing` without one or if it is unreadable.
Rgb light_color(Parameters& parameters, std::string_view name, Rgb missing, const Context& context);

/// Returns the colour of a reflectance or transmittance, in [0, 1]; nothing without one or if it is unreadable.
std::optional<Rgb> reflectance(Parameters& parameters, std::string_view name, const Context& context);

/// Returns a colour without limits, such as an absorption; nothing without one or if it is unreadable.
std::optional<Rgb> plain_color(Parameters& parameters, std::string_view name, const Context& context);

/// Returns an index of refraction or absorption for each channel; nothing without one or if it is unreadable.
std::optional<Rgb> index_of_channels(Parameters& parameters, std::string_view name, const Context& context);

/// Returns the glass that a parameter names (glass-BK7), or the number that it has; nothing without one. The Abbe
/// number of a number is 0.
std::optional<GlassIndex> glass_index(Parameters& parameters, std::string_view name, const Context& context);

} // namespace pertev::pbrt

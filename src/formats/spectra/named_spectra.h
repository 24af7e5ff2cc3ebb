#pragma once

// Spectra that scene files of pbrt and Mitsuba give by name: indices of metals and glasses, and standard illuminants.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/rgb.h"

namespace pertev {

/// A complex index of refraction for each channel.
struct ComplexIndex {
    Rgb eta, k;
};

/// Returns the index of a metal by pbrt's or Mitsuba's short name (Ag, Al, Au, Cu, CuZn, ...), in any case, or by its
/// English one (scene/metals.h), or of the two crystals in pbrt's list; nothing for another.
std::optional<ComplexIndex> find_metal_index(std::string_view name);

/// A glass by its index at 587.6 nm and its Abbe number.
struct GlassIndex {
    float ior, abbe_number;
};
/// Returns the optical glass of Schott with this name, without its `glass-`, such as BK7; nothing for another. F5, F10
/// and F11 are SF5, SF10 and SF11, as pbrt names them.
std::optional<GlassIndex> find_glass(std::string_view name);

/// Returns the colour, of luminance 1, of an illuminant by pbrt's name, such as stdillum-D65; nothing for another.
std::optional<Rgb> find_illuminant(std::string_view name);

/// Returns pbrt's names of all spectra above, for an answer to an unknown name.
std::vector<std::string> names_of_spectra();

} // namespace pertev

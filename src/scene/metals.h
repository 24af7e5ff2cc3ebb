#pragma once

// Measured metals by name, for materials of the kind Conductor. tools/make_metals.py writes their table.

#include <span>
#include <string>
#include <string_view>

#include "math/rgb.h"

namespace pertev {

struct MeasuredMetal {
    std::string_view name; // English
    Rgb eta, k;            // complex index eta + i k of each channel
};

/// Returns all metals, by their names' order.
std::span<const MeasuredMetal> measured_metals();

/// Returns the metal of this name, or null.
const MeasuredMetal* find_metal(std::string_view name);

/// Returns the names of all for an answer to an unknown one.
std::string names_of_metals();

} // namespace pertev

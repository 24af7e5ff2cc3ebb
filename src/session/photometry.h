#pragma once

// Light as the eye and cameras take it: lumens of a scene's watts, and the exposure of a camera's film.

#include <string>

namespace pertev {

/// Of a watt at the peak of the eye's response, lm/W; by it watts of luminance count as lumens.
inline constexpr double kLumensPerWatt = 683;

/// What a watt of luminance counts as in a scene of this name, lm/W: 1 for glTF, which states lamps in candela, lux and
/// nits, read as watts one for one (docs/formats.md), else kLumensPerWatt. `asked_for`: instead of that; 0: nothing.
double lumens_per_watt(const std::string& scene, double asked_for = 0);

/// How a camera takes a picture.
struct PhysicalExposure {
    double iso = 100;     // speed
    double f_number = 0;  // focal length over the aperture's diameter
    double shutter_s = 0; // how long it is open, seconds
};

/// EV at ISO 100: log2 of N^2 / t times 100 / S.
double exposure_value(const PhysicalExposure& exposure);

/// Stops by which a picture is shown: 2^stops times a luminance of 1.2 * 2^EV cd/m2 is 1, the film's white. Saturation
/// based speed, S = 78 / H, with H = q L t / N^2 and q = 0.65 for a usual lens.
///
/// Sources: ISO 12232:2006; Lagarde, de Rousiers, "Moving Frostbite to Physically Based Rendering", SIGGRAPH 2014
/// course notes, section 5.1.
float exposure_stops(const PhysicalExposure& exposure, double lumens_per_watt);

} // namespace pertev

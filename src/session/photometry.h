#pragma once

// Photometry: lumens of a scene's watts, the colour that stays when they change, and the exposure of a camera's film.

#include <string>

#include "math/rgb.h"

namespace pertev {

/// Lumens per watt at the peak of the eye's response, lm/W; applied to watts of luminance.
inline constexpr double kLumensPerWatt = 683;

/// Lumens per watt of luminance for a scene of this name, lm/W: 1 for glTF, which states lights in candela, lux and
/// nits, read as watts one for one (docs/formats.md), else kLumensPerWatt. `requested` overrides it; 0: no override.
double lumens_per_watt(const std::string& scene, double requested = 0);

/// Returns the colour of an emitter of this strength, of any luminance above 0; that of a black one is white.
inline Rgb color_of_emitter(Rgb strength) { return is_black(strength) ? grey(1) : strength; }

/// The exposure of a physical camera.
struct PhysicalExposure {
    double iso = 100;     // film speed
    double f_number = 0;  // focal length over aperture diameter
    double shutter_s = 0; // exposure time, seconds
};

/// EV at ISO 100: log2 of N^2 / t times 100 / S.
double exposure_value(const PhysicalExposure& exposure);

/// Stops by which the picture is brightened: 2^stops times a luminance of 1.2 * 2^EV cd/m2 is 1, the film's white.
/// This is saturation-based speed, S = 78 / H, with H = q L t / N^2 and q = 0.65 for a usual lens.
///
/// Sources: ISO 12232:2006; Lagarde, de Rousiers, "Moving Frostbite to Physically Based Rendering", SIGGRAPH 2014
/// course notes, section 5.1.
float exposure_stops(const PhysicalExposure& exposure, double lumens_per_watt);

} // namespace pertev

#pragma once

// A clear sky with the sun as a panorama, by closed formulas of the turbidity: Perez' distribution of luminance and
// chromaticity with the coefficients of Preetham et al., and the sun's radiance through the air, aerosols, ozone
// and water vapour (mixed gases attenuate only above 750 nm). Below the horizon it is black.
//
// Source: Preetham, Shirley, Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999, appendices A.1 and A.2.

#include <optional>
#include <string>

#include "math/rgb.h"
#include "math/vec3.h"
#include "scene/light.h"

namespace pertev {

/// Half the angle that the sun covers, radians.
inline constexpr float kSunRadius = 0.2665f * (kPi / 180);
/// Lumens of light of 1 W/nm at all wavelengths, by the observer of 1931.
inline constexpr double kLumensOfFlatLight = 683.002 * 106.857;
inline constexpr double kLeastTurbidity = 2, kMostTurbidity = 10;

struct SunSky {
    Vec3 zenith = {0, 1, 0}, sun = {0, 1, 0}; // unit vectors of the scene, the latter towards the sun
    double turbidity = 3;                     // haze: 2 is clear, 10 is hazy
    float sky_scale = 1, sun_scale = 1;       // factors of the radiance; 0 leaves a part out
    float sun_radius = kSunRadius;            // above 0; the light in all stays the same
};

/// Returns the sky of a text "ELEVATION,AZIMUTH[,TURBIDITY]": degrees above the horizon, in [0, 90], and degrees from
/// -z towards +x, as a compass has them where -z is north. Nothing for any other text.
std::optional<SunSky> parse_sun_sky(const std::string& text);

/// Returns the sky's radiance from the unit direction `d`, without the sun, in cd/m2.
Rgb sky_luminance(const SunSky& sky, Vec3 d);
/// Returns the radiance of the sun's disk, of radius kSunRadius, at the ground, in cd/m2.
Rgb sun_luminance(const SunSky& sky);

/// Returns the panorama of sky and sun. A watt has `lumens_per_watt`.
Environment make_sun_sky(const SunSky& sky, double lumens_per_watt);

} // namespace pertev

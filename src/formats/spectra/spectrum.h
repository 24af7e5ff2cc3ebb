#pragma once

// Spectra of scene files as linear Rec. 709.
//
// Source: CIE 15 for the observer of 1931 and D65; Planck's law with the constants of the SI. Sums run over 380 to 780
// nm in steps of 5 nm. Arithmetic is double, in a fixed order, with portable functions.

#include <span>
#include <vector>

#include "math/rgb.h"

namespace pertev {

/// A function of the wavelength, linear between its points and constant beyond them. Without points it is 0.
struct Spectrum {
    std::vector<double> wavelengths_nm; // ascending
    std::vector<double> values;         // one for each wavelength

    double at(double wavelength_nm) const;
};

/// Makes a spectrum of pairs of wavelength and value in any order; a surplus number is ignored.
Spectrum make_spectrum(std::span<const double> pairs);

/// Returns the colour of light with this spectrum. A constant spectrum of 1 has luminance 1. Colours outside Rec. 709
/// have negative channels, which become 0, so that the luminance is a little too high.
Rgb color_of_light(const Spectrum& spectrum);
/// Returns the colour of light with this spectrum, scaled to luminance 1; black for black.
Rgb color_of_unit_light(const Spectrum& spectrum);
/// Returns the colour of a surface with this reflectance under D65, in [0, 1]: that of a constant 1 is (1, 1, 1).
Rgb color_of_reflectance(const Spectrum& reflectance);
/// Returns the colour as color_of_reflectance(), but without limits, for numbers that are no reflectance; negative
/// channels become 0.
Rgb color_under_d65(const Spectrum& spectrum);
/// Returns the mean of a spectrum as each channel of Rec. 709 sees it under D65, for indices of refraction: the
/// negative parts of the channels' sensitivities are left out.
Rgb means_of_channels(const Spectrum& spectrum);

/// Returns the radiance of a black body over that at its brightest wavelength. `temperature_k` is above 0.
Spectrum black_body(double temperature_k);

/// Returns the colour, of luminance 1, with this CIE 1931 chromaticity.
Rgb color_of_chromaticity(double x, double y);

} // namespace pertev

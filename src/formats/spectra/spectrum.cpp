#include "formats/spectra/spectrum.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "math/portable_math.h"

namespace pertev {
namespace {

#include "formats/spectra/cie_1931.inl"

constexpr double kFirst = 380, kStep = 5;
constexpr std::size_t kCount = 81;
// Inverse of the primaries of Rec. 709 with the white D65 (IEC 61966-2-1).
constexpr double kRgbFromXyz[3][3] = {
    {3.2404542, -1.5371385, -0.4985314}, {-0.9692660, 1.8760108, 0.0415560}, {0.0556434, -0.2040259, 1.0572252}};

using Triple = std::array<double, 3>;

double d65_at(std::size_t i) { return i % 2 == 0 ? kD65[i / 2] : 0.5 * (kD65[i / 2] + kD65[i / 2 + 1]); }

Triple rgb_from_xyz(const Triple& xyz) {
    Triple rgb = {};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t k = 0; k < 3; ++k) rgb[c] += kRgbFromXyz[c][k] * xyz[k];
    return rgb;
}

/// Sums weight(i) times the observer over all wavelengths.
template <class Weight>
Triple sum_observed(const Weight& weight) {
    Triple sum = {};
    for (std::size_t i = 0; i < kCount; ++i) {
        const double w = weight(i);
        for (std::size_t k = 0; k < 3; ++k) sum[k] += w * kObserver[i][k];
    }
    return sum;
}

Rgb not_negative(const Triple& rgb, double scale) {
    const auto channel = [&](double value) { return static_cast<float>(std::max(scale * value, 0.0)); };
    return {channel(rgb[0]), channel(rgb[1]), channel(rgb[2])};
}

double wavelength(std::size_t i) { return kFirst + kStep * static_cast<double>(i); }

} // namespace

double Spectrum::at(double wavelength_nm) const {
    if (values.empty()) return 0;
    const auto above = std::ranges::upper_bound(wavelengths_nm, wavelength_nm);
    if (above == wavelengths_nm.begin()) return values.front();
    if (above == wavelengths_nm.end()) return values.back();
    const auto i = static_cast<std::size_t>(above - wavelengths_nm.begin());
    const double part = (wavelength_nm - wavelengths_nm[i - 1]) / (wavelengths_nm[i] - wavelengths_nm[i - 1]);
    return values[i - 1] + part * (values[i] - values[i - 1]);
}

Spectrum make_spectrum(std::span<const double> pairs) {
    std::vector<std::size_t> order(pairs.size() / 2);
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return pairs[2 * i]; });
    Spectrum spectrum;
    for (const std::size_t i : order) {
        spectrum.wavelengths_nm.push_back(pairs[2 * i]);
        spectrum.values.push_back(pairs[2 * i + 1]);
    }
    return spectrum;
}

Rgb color_of_light(const Spectrum& spectrum) {
    const double unit = sum_observed([](std::size_t) { return 1.0; })[1];
    return not_negative(rgb_from_xyz(sum_observed([&](std::size_t i) { return spectrum.at(wavelength(i)); })),
                        1 / unit);
}

Rgb color_of_unit_light(const Spectrum& spectrum) {
    const Triple xyz = sum_observed([&](std::size_t i) { return spectrum.at(wavelength(i)); });
    return xyz[1] > 0 ? not_negative(rgb_from_xyz(xyz), 1 / xyz[1]) : Rgb{};
}

Rgb color_under_d65(const Spectrum& spectrum) {
    const Triple white = rgb_from_xyz(sum_observed(d65_at));
    const Triple seen =
        rgb_from_xyz(sum_observed([&](std::size_t i) { return d65_at(i) * spectrum.at(wavelength(i)); }));
    return not_negative({seen[0] / white[0], seen[1] / white[1], seen[2] / white[2]}, 1);
}

Rgb color_of_reflectance(const Spectrum& reflectance) {
    const Rgb color = color_under_d65(reflectance);
    return {min(color.r, 1.0f), min(color.g, 1.0f), min(color.b, 1.0f)};
}

Rgb means_of_channels(const Spectrum& spectrum) {
    Triple sum = {}, weights = {};
    for (std::size_t i = 0; i < kCount; ++i) {
        const Triple seen = rgb_from_xyz({kObserver[i][0], kObserver[i][1], kObserver[i][2]});
        const double value = spectrum.at(wavelength(i));
        for (std::size_t c = 0; c < 3; ++c) {
            const double weight = std::max(seen[c], 0.0) * d65_at(i);
            sum[c] += weight * value;
            weights[c] += weight;
        }
    }
    return not_negative({sum[0] / weights[0], sum[1] / weights[1], sum[2] / weights[2]}, 1);
}

Spectrum black_body(double temperature_k) {
    constexpr double kSecondConstant = 1.438776877e7; // nm K
    constexpr double kWien = 2.897771955e6;           // nm K
    const auto radiance = [&](double nm) {
        const double inverse = 1000 / nm, square = inverse * inverse;
        const auto power = static_cast<float>(std::min(kSecondConstant / (nm * temperature_k), 80.0));
        return square * square * inverse / (static_cast<double>(exp(power)) - 1);
    };
    const double most = radiance(kWien / temperature_k);
    Spectrum spectrum;
    for (std::size_t i = 0; i < kCount; ++i) {
        spectrum.wavelengths_nm.push_back(wavelength(i));
        spectrum.values.push_back(radiance(wavelength(i)) / most);
    }
    return spectrum;
}

Rgb color_of_chromaticity(double x, double y) { return not_negative(rgb_from_xyz({x / y, 1, (1 - x - y) / y}), 1); }

} // namespace pertev

#include "formats/sun_sky/sun_sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel_for.h"
#include "formats/files/parse_number.h"
#include "formats/spectra/spectrum.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

constexpr float kDegree = kPi / 180;

/// Coefficients A to E of Perez' formula for one quantity.
using Perez = std::array<float, 5>;

/// Each coefficient is a linear function of the turbidity: slope, then constant.
Perez perez_at(const float (&linear)[5][2], float turbidity) {
    Perez perez;
    for (std::size_t i = 0; i < 5; ++i) perez[i] = linear[i][0] * turbidity + linear[i][1];
    return perez;
}

/// Perez' formula at the cosine of the angle from the zenith, and at the angle from the sun.
float perez_value(const Perez& p, float cos_zenith, float from_sun) {
    const float c = cos(from_sun);
    return (1 + p[0] * exp(p[1] / max(cos_zenith, 1e-3f))) * (1 + p[2] * exp(p[3] * from_sun) + p[4] * c * c);
}

/// A cubic in the sun's angle from the zenith whose coefficients are quadratic in the turbidity.
float zenith_chromaticity(const float (&m)[3][4], float turbidity, float angle) {
    float value = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const float row = ((m[i][0] * angle + m[i][1]) * angle + m[i][2]) * angle + m[i][3];
        value = value * turbidity + row;
    }
    return value;
}

constexpr float kPerezY[5][2] = {
    {0.1787f, -1.4630f}, {-0.3554f, 0.4275f}, {-0.0227f, 5.3251f}, {0.1206f, -2.5771f}, {-0.0670f, 0.3703f}};
constexpr float kPerezSmallX[5][2] = {
    {-0.0193f, -0.2592f}, {-0.0665f, 0.0008f}, {-0.0004f, 0.2125f}, {-0.0641f, -0.8989f}, {-0.0033f, 0.0452f}};
constexpr float kPerezSmallY[5][2] = {
    {-0.0167f, -0.2608f}, {-0.0950f, 0.0092f}, {-0.0079f, 0.2102f}, {-0.0441f, -1.6537f}, {-0.0109f, 0.0529f}};
constexpr float kZenithX[3][4] = {{0.00166f, -0.00375f, 0.00209f, 0},
                                  {-0.02903f, 0.06377f, -0.03202f, 0.00394f},
                                  {0.11693f, -0.21196f, 0.06052f, 0.25886f}};
constexpr float kZenithY[3][4] = {{0.00275f, -0.00610f, 0.00317f, 0},
                                  {-0.04214f, 0.08970f, -0.04153f, 0.00516f},
                                  {0.15346f, -0.26756f, 0.06670f, 0.26688f}};

/// The sky for one place of the sun.
class Sky {
public:
    explicit Sky(const SunSky& sky) : zenith_(sky.zenith), sun_(sky.sun) {
        const auto t = static_cast<float>(sky.turbidity);
        const float cos_sun = clamp(dot(zenith_, sun_), 0.0f, 1.0f), angle = acos(cos_sun);
        luminance_ = perez_at(kPerezY, t), x_ = perez_at(kPerezSmallX, t), y_ = perez_at(kPerezSmallY, t);
        const float chi = (4.0f / 9.0f - t / 120.0f) * (kPi - 2 * angle);
        const float zenith_kcd = (4.0453f * t - 4.9710f) * (sin(chi) / cos(chi)) - 0.2155f * t + 2.4192f;
        const auto at_zenith = [&](const Perez& p, float value) { return value / perez_value(p, 1, angle); };
        zenith_luminance_ = at_zenith(luminance_, 1000 * max(zenith_kcd, 0.0f));
        zenith_x_ = at_zenith(x_, zenith_chromaticity(kZenithX, t, angle));
        zenith_y_ = at_zenith(y_, zenith_chromaticity(kZenithY, t, angle));
    }

    /// Returns the radiance from a unit direction in cd/m2.
    Rgb at(Vec3 d) const {
        const float up = dot(d, zenith_);
        if (!(up > 0)) return {};
        const float from_sun = atan2(length(cross(d, sun_)), dot(d, sun_)); // exact near 0
        const float x = zenith_x_ * perez_value(x_, up, from_sun), y = zenith_y_ * perez_value(y_, up, from_sun);
        const float cd = zenith_luminance_ * perez_value(luminance_, up, from_sun);
        return max(cd, 0.0f) * color_of_chromaticity(static_cast<double>(x), static_cast<double>(y));
    }

private:
    Vec3 zenith_, sun_;
    Perez luminance_, x_, y_;
    float zenith_luminance_, zenith_x_, zenith_y_; // over Perez' formula at the zenith
};

// From 380 nm in steps of 10 nm: the sun's radiance outside of the atmosphere, 100 W/(sr m2 nm), and the attenuation by
// ozone, 1/cm.
constexpr double kSunRadiance[38] = {165.5, 162.3, 211.2, 258.8, 258.2, 242.3, 267.6, 296.6, 305.4, 300.6,
                                     306.6, 288.3, 287.1, 278.2, 271.0, 272.3, 263.6, 255.0, 250.6, 253.1,
                                     253.5, 251.3, 246.3, 241.7, 236.8, 232.1, 228.2, 223.4, 219.7, 215.3,
                                     211.0, 207.3, 202.4, 198.7, 194.3, 190.7, 186.3, 182.6};
constexpr double kOzone[38] = {0,     0,     0,     0,     0,     0,     0,     0.003, 0.006, 0.009,
                               0.014, 0.021, 0.030, 0.040, 0.048, 0.063, 0.075, 0.085, 0.103, 0.120,
                               0.120, 0.115, 0.125, 0.120, 0.105, 0.090, 0.079, 0.067, 0.057, 0.048,
                               0.036, 0.028, 0.023, 0.018, 0.014, 0.011, 0.010, 0.009};
// Attenuation by water vapour, 1/cm, from 690 nm in steps of 10 nm.
constexpr double kWater[7] = {0.016, 0.024, 0.0125, 1.0, 0.87, 0.061, 0.001};
constexpr double kFirstNm = 380, kStepNm = 10;

double power(double base, double exponent) {
    return static_cast<double>(pow(static_cast<float>(base), static_cast<float>(exponent)));
}

/// Returns the share of light of a wavelength that arrives through `mass` times the atmosphere at the zenith.
double transmittance(double nm, std::size_t i, double mass, double turbidity) {
    constexpr double kOzoneCm = 0.35, kWaterCm = 2, kAngstromExponent = 1.3;
    const double um = nm / 1000, beta = 0.04608365822050 * turbidity - 0.04586025928522;
    const double rayleigh = 0.008735 * power(um, -4.08) * mass, aerosol = beta * power(um, -kAngstromExponent) * mass;
    const double ozone = kOzone[i] * kOzoneCm * mass;
    const double water = i < 31 ? 0 : kWater[i - 31] * kWaterCm * mass;
    const double vapour = 0.2385 * water / power(1 + 20.07 * water, 0.45);
    return static_cast<double>(exp(static_cast<float>(-rayleigh - aerosol - ozone - vapour)));
}

/// Returns the direction at a place of a panorama, in [0, 1] from its first column and row (scene/light.h).
Vec3 panorama_direction(float u, float v) {
    const float around = 2 * kPi * (u - 0.5f), down = kPi * v;
    return {sin(down) * sin(around), cos(down), -sin(down) * cos(around)};
}

/// Returns the share of each pixel that the sun's disk covers, as if there were no horizon, and that above it.
struct Coverage {
    float whole = 0, visible = 0;
};
Coverage coverage_of(const SunSky& sky, uint32_t x, uint32_t y, uint32_t width, uint32_t height) {
    constexpr uint32_t kParts = 8;
    Coverage coverage;
    const float cos_radius = cos(sky.sun_radius);
    for (uint32_t i = 0; i < kParts * kParts; ++i) {
        const float u =
            (static_cast<float>(x) + (static_cast<float>(i % kParts) + 0.5f) / kParts) / static_cast<float>(width);
        const float v =
            (static_cast<float>(y) + (static_cast<float>(i / kParts) + 0.5f) / kParts) / static_cast<float>(height);
        const Vec3 d = panorama_direction(u, v);
        if (dot(d, sky.sun) < cos_radius) continue;
        coverage.whole += 1.0f / (kParts * kParts);
        if (dot(d, sky.zenith) > 0) coverage.visible += 1.0f / (kParts * kParts);
    }
    return coverage;
}

} // namespace

std::optional<SunSky> parse_sun_sky(const std::string& text) {
    std::vector<double> numbers;
    for (std::string_view rest = text;;) {
        const std::optional<double> number = parse_float<double>(rest);
        if (!number) return std::nullopt;
        numbers.push_back(*number);
        if (rest.empty()) break;
        if (rest.front() != ',') return std::nullopt;
        rest.remove_prefix(1);
    }
    if (numbers.size() < 2 || numbers.size() > 3) return std::nullopt;
    SunSky sky;
    if (numbers.size() == 3) sky.turbidity = numbers[2];
    const bool has_range = numbers[0] >= 0 && numbers[0] <= 90 && std::abs(numbers[1]) <= 1e6 &&
                           sky.turbidity >= kLeastTurbidity && sky.turbidity <= kMostTurbidity;
    if (!has_range) return std::nullopt;
    const float up = static_cast<float>(numbers[0]) * kDegree;
    const float around = static_cast<float>(std::fmod(numbers[1], 360.0)) * kDegree;
    sky.sun = {cos(up) * sin(around), sin(up), -cos(up) * cos(around)};
    return sky;
}

Rgb sky_luminance(const SunSky& sky, Vec3 d) { return Sky(sky).at(d); }

Rgb sun_luminance(const SunSky& sky) {
    const float cos_sun = clamp(dot(sky.zenith, sky.sun), 0.0f, 1.0f);
    const double angle = static_cast<double>(acos(cos_sun));
    const double mass =
        1 / (static_cast<double>(cos_sun) + 0.15 * power(93.885 - angle / static_cast<double>(kDegree), -1.253));
    Spectrum spectrum;
    for (std::size_t i = 0; i < std::size(kSunRadiance); ++i) {
        const double nm = kFirstNm + kStepNm * static_cast<double>(i);
        spectrum.wavelengths_nm.push_back(nm);
        spectrum.values.push_back(100 * kSunRadiance[i] * transmittance(nm, i, mass, sky.turbidity));
    }
    return static_cast<float>(kLumensOfFlatLight) * color_of_light(spectrum);
}

Environment make_sun_sky(const SunSky& sky, double lumens_per_watt) {
    Environment environment;
    Image& image = environment.image;
    const bool has_sun = sky.sun_scale > 0;
    image.width = has_sun ? 2048 : 512, image.height = image.width / 2; // the sun has a diameter of three pixels
    image.pixels.resize(std::size_t(3) * image.width * image.height);
    const Sky model(sky);
    const auto watts = static_cast<float>(1 / lumens_per_watt);
    parallel_for(image.height, 4, [&](uint64_t row) {
        for (uint32_t x = 0; x < image.width; ++x) {
            const auto y = static_cast<uint32_t>(row);
            const Vec3 d = panorama_direction((static_cast<float>(x) + 0.5f) / static_cast<float>(image.width),
                                              (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height));
            const Rgb color = watts * sky.sky_scale * model.at(d);
            float* const pixel = image.at(x, y);
            pixel[0] = color.r, pixel[1] = color.g, pixel[2] = color.b;
        }
    });
    if (!has_sun) return environment;
    struct SunPixel {
        uint32_t x, y;
        float visible;
    };
    std::vector<SunPixel> pixels;
    double covered = 0; // steradians
    const float cell = kPi / static_cast<float>(image.height), cos_near = cos(min(sky.sun_radius + 2 * cell, kPi));
    for (uint32_t y = 0; y < image.height; ++y) {
        const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height);
        for (uint32_t x = 0; x < image.width; ++x) {
            const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(image.width);
            if (dot(panorama_direction(u, v), sky.sun) < cos_near) continue;
            const Coverage coverage = coverage_of(sky, x, y, image.width, image.height);
            covered += static_cast<double>(coverage.whole * cell * cell * sin(kPi * v));
            if (coverage.visible > 0) pixels.push_back({x, y, coverage.visible});
        }
    }
    constexpr double kSolidAngle = 6.7967e-5; // steradians that a disk of kSunRadius covers
    const auto scale = static_cast<float>(covered > 0 ? kSolidAngle / covered : 0);
    const Rgb sun = watts * sky.sun_scale * scale * sun_luminance(sky);
    for (const SunPixel& of : pixels) {
        float* const pixel = image.at(of.x, of.y);
        pixel[0] += of.visible * sun.r, pixel[1] += of.visible * sun.g, pixel[2] += of.visible * sun.b;
    }
    return environment;
}

} // namespace pertev

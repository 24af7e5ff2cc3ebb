// The order of samples in frames: what single samples of smooth integrands get wrong is blue noise over the picture and
// over time. The spectrum of the errors is that of a cube of pixels and frames, by a discrete cosine transform; white
// noise has the same power everywhere, 1 here.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "math/sampler.h"

using namespace pertev;

namespace {

constexpr uint32_t kSide = 32, kTimes = 32;

using Integrand = std::function<double(Vec2, Vec2)>; // of the two pairs of a group

/// Along one axis of a cube, in place: `stride` from one value to the next. Orthonormal (DCT-II).
void transform_line(std::vector<double>& values, std::size_t first, std::size_t stride, uint32_t count) {
    static std::vector<double> cosines;
    cosines.resize(std::size_t(4) * count);
    for (uint32_t k = 0; k < 4 * count; ++k) cosines[k] = std::cos(3.14159265358979 * k / (2.0 * count));
    std::vector<double> line(count), out(count);
    for (uint32_t i = 0; i < count; ++i) line[i] = values[first + i * stride];
    for (uint32_t k = 0; k < count; ++k) {
        double sum = 0;
        for (uint32_t i = 0; i < count; ++i) sum += line[i] * cosines[k * (2 * i + 1) % (4 * count)];
        out[k] = sum * std::sqrt((k == 0 ? 1.0 : 2.0) / count);
    }
    for (uint32_t i = 0; i < count; ++i) values[first + i * stride] = out[i];
}

/// Mean power of bands of the errors' spectrum, over the errors' variance.
struct Spectrum {
    double low_in_space = 0;  // of single frames: both frequencies in the lowest quarter
    double high_in_space = 0; // both in the upper half
    double low_in_time = 0;   // of single pixels: in the lowest quarter
    double low_in_both = 0;
};

Spectrum spectrum_of(SamplerKind kind, const Integrand& integrand) {
    Spectrum mean;
    constexpr int kRepeats = 6;
    for (uint32_t repeat = 0; repeat < kRepeats; ++repeat) {
        constexpr std::size_t kCount = std::size_t(kSide) * kSide * kTimes;
        std::vector<double> errors(kCount);
        double sum = 0, squares = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            // Not where blocks of the order begin.
            const uint32_t x = i % kSide + 211, y = i / kSide % kSide + 77,
                           time = static_cast<uint32_t>(i / kSide / kSide);
            const uint32_t pixel = kind == SamplerKind::SpaceTime ? morton_code(x, y) : y * 1920 + x;
            const SampleKey key = {pixel, time + 5, repeat};
            errors[i] = integrand(sample_2d(kind, key, 9), sample_2d(kind, key, 9, Pair::Last));
            sum += errors[i];
        }
        for (double& e : errors) {
            e -= sum / kCount;
            squares += e * e;
        }
        const double inv = 1 / (squares / kCount) / kRepeats;
        const auto band = [&](const std::vector<double>& power, auto is_in) {
            double total = 0, count = 0;
            for (std::size_t i = 1; i < kCount; ++i) { // 0 is the mean
                const uint32_t u = i % kSide, v = i / kSide % kSide, w = static_cast<uint32_t>(i / kSide / kSide);
                if (!is_in(u, v, w)) continue;
                total += power[i] * power[i];
                count += 1;
            }
            return inv * total / count;
        };
        std::vector<double> over_time = errors;
        for (std::size_t p = 0; p < kSide * kSide; ++p) transform_line(over_time, p, kSide * kSide, kTimes);
        mean.low_in_time += band(over_time, [](uint32_t, uint32_t, uint32_t w) { return w < kTimes / 4; });
        for (std::size_t line = 0; line < std::size_t(kSide) * kTimes; ++line) {
            transform_line(errors, line * kSide, 1, kSide);
        }
        for (std::size_t line = 0; line < std::size_t(kSide) * kTimes; ++line) {
            transform_line(errors, line / kSide * kSide * kSide + line % kSide, kSide, kSide);
        }
        mean.low_in_space += band(errors, [](uint32_t u, uint32_t v, uint32_t) { return u < 8 && v < 8 && u + v > 0; });
        mean.high_in_space += band(errors, [](uint32_t u, uint32_t v, uint32_t) { return u >= 16 && v >= 16; });
        for (std::size_t p = 0; p < kSide * kSide; ++p) transform_line(errors, p, kSide * kSide, kTimes);
        mean.low_in_both += band(errors, [](uint32_t u, uint32_t v, uint32_t w) { return u < 8 && v < 8 && w < 8; });
    }
    return mean;
}

} // namespace

TEST_CASE("errors of frames' samples are blue noise over the picture and over time") {
    struct Case {
        const char* name;
        Integrand integrand;
        double in_space, in_time, in_both; // most power of low frequencies
    };
    const std::vector<Case> cases = {
        {"of one number", [](Vec2 u, Vec2) { return double(u.x) * double(u.x); }, 0.4, 0.3, 0.15},
        {"of a pair", [](Vec2 u, Vec2) { return double(u.x) * double(u.y); }, 0.5, 0.5, 0.25},
        {"of the other pair", [](Vec2, Vec2 v) { return double(v.x) * double(v.y); }, 0.5, 0.5, 0.25},
        {"of three", [](Vec2 u, Vec2 v) { return double(u.x) * double(u.y) * double(v.x); }, 0.7, 0.7, 0.6},
    };
    for (const Case& c : cases) {
        const Spectrum ordered = spectrum_of(SamplerKind::SpaceTime, c.integrand),
                       white = spectrum_of(SamplerKind::Independent, c.integrand),
                       by_pixel = spectrum_of(SamplerKind::Sobol, c.integrand);
        const auto say = [](const std::string& name, const Spectrum& s) {
            MESSAGE(name, ": low in space ", s.low_in_space, ", high ", s.high_in_space, ", low in time ",
                    s.low_in_time, ", in both ", s.low_in_both);
        };
        INFO(std::string(c.name));
        say(c.name, ordered);
        say("white noise", white);
        say("each pixel by itself", by_pixel);
        CHECK(white.low_in_space == doctest::Approx(1).epsilon(0.1));
        CHECK(white.low_in_time == doctest::Approx(1).epsilon(0.1));
        CHECK(by_pixel.low_in_space == doctest::Approx(1).epsilon(0.1));
        CHECK(ordered.low_in_space < c.in_space);
        CHECK(ordered.low_in_time < c.in_time);
        CHECK(ordered.low_in_both < c.in_both);
        CHECK(ordered.low_in_both < by_pixel.low_in_both);
        CHECK(ordered.high_in_space > 1);
    }
}

TEST_CASE("each pixel's samples over frames are as evenly spread as before") {
    for (const uint32_t pixel : {morton_code(0, 0), morton_code(13, 7), morton_code(1919, 1079)}) {
        for (uint32_t number = 0; number < 4; ++number) {
            std::array<uint32_t, 16> counts = {};
            for (uint32_t time = 0; time < 64; ++time) {
                ++counts[static_cast<std::size_t>(16 * sample_1d(SamplerKind::SpaceTime, {pixel, time, 3}, 4, number))];
            }
            for (const uint32_t count : counts) CHECK(count == 4);
        }
    }
}

TEST_CASE("the pixels of a block of a frame take points that are stratified together") {
    for (const uint32_t time : {0u, 1u, 63u, 1000u}) {
        for (uint32_t number = 0; number < 4; ++number) {
            std::array<uint32_t, 256> counts = {};
            for (uint32_t i = 0; i < 256; ++i) {
                const uint32_t pixel = morton_code(32 + i % 16, 48 + i / 16);
                ++counts[static_cast<std::size_t>(256 *
                                                  sample_1d(SamplerKind::SpaceTime, {pixel, time, 3}, 4, number))];
            }
            for (const uint32_t count : counts) CHECK(count == 1);
        }
    }
}

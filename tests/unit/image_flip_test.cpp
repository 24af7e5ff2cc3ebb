// FLIP is compared with a second implementation of the paper: in double, with the two-dimensional filters as they
// are printed instead of products of one-dimensional ones.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "base/error.h"
#include "image/flip.h"

using namespace pertev;

namespace {

using Colour = std::array<double, 3>;
using Kernel = std::function<double(int, int)>; // the weight at an offset

constexpr double kPiInDouble = 3.14159265358979323846;

struct Grid {
    int width, height;
    std::vector<Colour> pixels;
    const Colour& at(int x, int y) const {
        return pixels[static_cast<std::size_t>(std::clamp(y, 0, height - 1) * width + std::clamp(x, 0, width - 1))];
    }
};

const double kMatrix[3][3] = {{10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
                              {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
                              {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

// Returns XYZ relative to white.
Colour relative_xyz(const Colour& rgb) {
    Colour result{};
    for (std::size_t i = 0; i < 3; ++i) {
        double white = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            result[i] += kMatrix[i][k] * rgb[k];
            white += kMatrix[i][k];
        }
        result[i] /= white;
    }
    return result;
}

Colour ycxcz(const Colour& rgb) {
    const Colour v = relative_xyz(rgb);
    return {116 * v[1] - 16, 500 * (v[0] - v[1]), 200 * (v[1] - v[2])};
}

// Solves for RGB by Cramer's rule on the matrix above.
Colour rgb_of_relative_xyz(const Colour& v) {
    double m[3][3], right[3];
    for (std::size_t i = 0; i < 3; ++i) {
        right[i] = v[i] * (kMatrix[i][0] + kMatrix[i][1] + kMatrix[i][2]);
        for (std::size_t k = 0; k < 3; ++k) m[i][k] = kMatrix[i][k];
    }
    const auto det = [](const double(&a)[3][3]) {
        return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
               a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    Colour result{};
    for (std::size_t k = 0; k < 3; ++k) {
        double replaced[3][3];
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) replaced[i][j] = j == k ? right[i] : m[i][j];
        result[k] = det(replaced) / det(m);
    }
    return result;
}

Colour hunt_lab(const Colour& rgb) {
    Colour v = relative_xyz(rgb);
    for (double& t : v) t = t > 216.0 / 24389 ? std::cbrt(t) : t * 841 / 108 + 4.0 / 29;
    const double lightness = 116 * v[1] - 16;
    return {lightness, 0.01 * lightness * 500 * (v[0] - v[1]), 0.01 * lightness * 200 * (v[1] - v[2])};
}

double hyab(const Colour& a, const Colour& b) { return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]); }

double filtered(const Grid& grid, std::size_t channel, int x, int y, int radius, const Kernel& kernel) {
    double sum = 0;
    for (int dy = -radius; dy <= radius; ++dy)
        for (int dx = -radius; dx <= radius; ++dx) sum += kernel(dx, dy) * grid.at(x + dx, y + dy)[channel];
    return sum;
}

Kernel normalized(int radius, Kernel kernel, bool is_signed) {
    double positive = 0, negative = 0;
    for (int dy = -radius; dy <= radius; ++dy)
        for (int dx = -radius; dx <= radius; ++dx) (kernel(dx, dy) > 0 ? positive : negative) += kernel(dx, dy);
    if (!is_signed) positive += negative;
    return [=](int x, int y) {
        const double weight = kernel(x, y);
        return weight / (is_signed && weight < 0 ? -negative : positive);
    };
}

std::vector<double> flip_in_double(const Image& a, const Image& b, double ppd) {
    const double params[3][4] = {{1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};
    const int colour_radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPiInDouble * kPiInDouble)) * ppd));
    std::array<Kernel, 3> sensitivity;
    for (std::size_t c = 0; c < 3; ++c) {
        const double a1 = params[c][0], b1 = params[c][1], a2 = params[c][2], b2 = params[c][3];
        sensitivity[c] = normalized(
            colour_radius,
            [=](int x, int y) {
                const double d2 = (x * x + y * y) / (ppd * ppd), p2 = kPiInDouble * kPiInDouble;
                return a1 * std::sqrt(kPiInDouble / b1) * std::exp(-p2 * d2 / b1) +
                       a2 * std::sqrt(kPiInDouble / b2) * std::exp(-p2 * d2 / b2);
            },
            false);
    }
    const double sd = 0.5 * 0.082 * ppd;
    const int feature_radius = static_cast<int>(std::ceil(3 * sd));
    const auto bell = [=](int x, int y) { return std::exp(-(x * x + y * y) / (2 * sd * sd)); };
    const Kernel edge = normalized(
        feature_radius, [=](int x, int y) { return -x * bell(x, y); }, true);
    const Kernel point = normalized(
        feature_radius, [=](int x, int y) { return (x * x / (sd * sd) - 1) * bell(x, y); }, true);
    const auto strength = [&](const Grid& grid, int x, int y, const Kernel& kernel) {
        return std::hypot(filtered(grid, 0, x, y, feature_radius, kernel),
                          filtered(grid, 0, x, y, feature_radius, [&](int dx, int dy) { return kernel(dy, dx); }));
    };

    std::array<Grid, 2> opponent, lightness;
    for (std::size_t k = 0; k < 2; ++k) {
        const Image& image = k == 0 ? a : b;
        opponent[k] = lightness[k] = {static_cast<int>(image.width), static_cast<int>(image.height), {}};
        for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
            const Colour c = ycxcz({double(image.pixels[i]), double(image.pixels[i + 1]), double(image.pixels[i + 2])});
            opponent[k].pixels.push_back(c);
            lightness[k].pixels.push_back({(c[0] + 16) / 116, 0, 0});
        }
    }
    const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
    std::vector<double> map;
    for (int y = 0; y < opponent[0].height; ++y) {
        for (int x = 0; x < opponent[0].width; ++x) {
            std::array<Colour, 2> seen;
            for (std::size_t k = 0; k < 2; ++k) {
                Colour c;
                for (std::size_t i = 0; i < 3; ++i)
                    c[i] = filtered(opponent[k], i, x, y, colour_radius, sensitivity[i]);
                const double relative_y = (c[0] + 16) / 116;
                Colour rgb = rgb_of_relative_xyz({relative_y + c[1] / 500, relative_y, relative_y - c[2] / 200});
                for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
                seen[k] = hunt_lab(rgb);
            }
            const double power = std::pow(hyab(seen[0], seen[1]), 0.7), knee = 0.4 * largest;
            const double colour = power < knee ? 0.95 / knee * power : 0.95 + 0.05 * (power - knee) / (largest - knee);
            const double edges = std::abs(strength(lightness[0], x, y, edge) - strength(lightness[1], x, y, edge));
            const double points = std::abs(strength(lightness[0], x, y, point) - strength(lightness[1], x, y, point));
            map.push_back(std::pow(colour, 1 - std::sqrt(std::max(edges, points) / std::sqrt(2.0))));
        }
    }
    return map;
}

// Patches of colour with a few hard edges and points; values in [0, 1].
Image patches(uint32_t width, uint32_t height, uint32_t seed) {
    Image image{width, height, 3, {}};
    uint32_t state = seed;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            for (uint32_t c = 0; c < 3; ++c) {
                state = state * 1664525u + 1013904223u;
                const float noise = static_cast<float>(state >> 24) / 255.0f;
                const float patch = static_cast<float>((x / 6 * 3 + y / 5 * 2 + c + seed) % 5) / 4.0f;
                image.pixels.push_back((x + y) % 7 == 0 ? noise : 0.8f * patch + 0.2f * noise);
            }
        }
    }
    return image;
}

Image filled(uint32_t side, float r, float g, float b) {
    Image image{side, side, 3, {}};
    for (uint32_t i = 0; i < side * side; ++i)
        for (const float v : {r, g, b}) image.pixels.push_back(v);
    return image;
}

} // namespace

TEST_CASE("FLIP agrees with the paper's formulas in double, pixel by pixel, near and far from the display") {
    const Image a = patches(23, 19, 1), b = patches(23, 19, 2);
    for (const float ppd : {20.0f, kDefaultPixelsPerDegree}) {
        const FlipResult result = flip(a, b, ppd);
        const std::vector<double> wanted = flip_in_double(a, b, double(ppd));
        REQUIRE(result.map.pixels.size() == wanted.size());
        double sum = 0;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            CHECK(std::abs(double(result.map.pixels[i]) - wanted[i]) < 2e-4);
            sum += wanted[i];
        }
        CHECK(result.mean == doctest::Approx(sum / static_cast<double>(wanted.size())).epsilon(1e-4));
        CHECK(result.mean > 0.1);
    }
}

TEST_CASE("equal pictures have FLIP 0 at every pixel, and FLIP is symmetric to the bit") {
    const Image a = patches(40, 30, 3), b = patches(40, 30, 4);
    CHECK(flip(a, a).map.pixels == std::vector<float>(40 * 30, 0.0f));
    CHECK(flip(a, b).map.pixels == flip(b, a).map.pixels);
    CHECK(hdr_flip(a, a).mean == 0);
}

TEST_CASE("FLIP of black against white is 0.95 plus the part of the last 5 % for their 100 units of lightness") {
    const double largest = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7), knee = 0.4 * largest;
    const double wanted = 0.95 + 0.05 * (std::pow(100.0, 0.7) - knee) / (largest - knee);
    CHECK(flip(filled(32, 0, 0, 0), filled(32, 1, 1, 1)).mean == doctest::Approx(wanted).epsilon(1e-4));
    CHECK(wanted == doctest::Approx(0.97).epsilon(0.01));
    CHECK(flip(filled(32, 0, 1, 0), filled(32, 0, 0, 1)).mean == doctest::Approx(1).epsilon(1e-4));
}

TEST_CASE("FLIP grows with the difference") {
    double before = 0;
    for (const float value : {0.21f, 0.25f, 0.35f, 0.6f, 1.0f}) {
        const double now = flip(filled(32, value, value, value), filled(32, 0.2f, 0.2f, 0.2f)).mean;
        CHECK(now > before);
        before = now;
    }
}

TEST_CASE("HDR-FLIP sees differences that clamping hides, and does not depend on the unit of light") {
    const Image bright = filled(32, 20, 20, 20), brighter = filled(32, 40, 40, 40);
    CHECK(flip(bright, brighter).mean == 0);
    CHECK(hdr_flip(bright, brighter).mean > 0.1);
    const Image a = patches(32, 32, 5), b = patches(32, 32, 6);
    Image a4 = a, b4 = b;
    for (float& v : a4.pixels) v *= 4;
    for (float& v : b4.pixels) v *= 4;
    CHECK(hdr_flip(a4, b4).mean == doctest::Approx(hdr_flip(a, b).mean).epsilon(1e-4));
}

TEST_CASE("FLIP stays within [0, 1] for values that are not finite and for pictures smaller than its filters") {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const Image a{2, 1, 3, {nan, -inf, inf, 0, 1, 1e30f}}, b{2, 1, 3, {1, 1, 1, 0, 0, 0}};
    for (const FlipResult& result : {flip(a, b), hdr_flip(a, b), hdr_flip(b, a)}) {
        for (const float error : result.map.pixels) CHECK((error >= 0 && error <= 1));
        CHECK(result.map.pixels[0] == 1); // not finite
        CHECK(result.mean > 0.5);
    }
    const Image black{2, 1, 3, {0, 0, 0, 0, 0, 0}}, one_nan{2, 1, 3, {0, 0, nan, 0, 0, 0}};
    for (const FlipResult& result : {flip(one_nan, black), flip(black, one_nan), hdr_flip(one_nan, black)})
        CHECK(result.map.pixels == std::vector<float>{1, 0});
    CHECK_THROWS_AS(flip(filled(3, 0, 0, 0), filled(4, 0, 0, 0)), Error);
}

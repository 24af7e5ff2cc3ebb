// Each warp of math/sampling.h maps uniform points to the density of its pdf function: chi-square over 10^6 samples.
// The tester itself must refuse a density that is slightly wrong.

#include <cmath>
#include <optional>
#include <vector>

#include <doctest/doctest.h>

#include "math/sampling.h"
#include "tests/support/chi_square.h"

using namespace pertev;
using test::chi_square_of_directions;
using test::chi_square_of_points;

namespace {

constexpr int kWarpTests = 11; // tests of this file, for the Sidak correction

void check(const test::ChiSquareResult& result) { CHECK_MESSAGE(result.passes(kWarpTests), result.describe()); }

double inside_disk(Vec2 p) { return p.x * p.x + p.y * p.y <= 1 ? 0.3183098861837907 : 0; }

RegularPolygon regular_polygon(int sides, double turn) {
    const double half = 3.141592653589793 / sides;
    const auto of = [](double x) { return static_cast<float>(x); };
    return {of(sides), of(1.0 / sides), of(std::cos(half)), of(2 * std::sin(half)), of(turn)};
}

/// Density of uniform points of a regular polygon in the unit circle, the middle of whose side is at `turn`.
struct PolygonDensity {
    std::vector<double> normals; // x and y
    double apothem, density;

    PolygonDensity(int sides, double turn) {
        const double step = 6.283185307179586 / sides;
        for (int i = 0; i < sides; ++i) {
            const double angle = 6.283185307179586 * turn + i * step;
            normals.insert(normals.end(), {std::cos(angle), std::sin(angle)});
        }
        apothem = std::cos(0.5 * step);
        density = 1 / (0.5 * sides * std::sin(step));
    }
    double operator()(Vec2 p) const {
        for (std::size_t i = 0; i < normals.size(); i += 2) {
            if (double(p.x) * normals[i] + double(p.y) * normals[i + 1] > apothem) return 0;
        }
        return density;
    }
};

} // namespace

TEST_CASE("cosine-weighted directions follow their density") {
    check(chi_square_of_directions([](float, Vec2 u) { return sample_cosine_hemisphere(u); },
                                   [](Vec3 w) { return static_cast<double>(pdf_cosine_hemisphere(w.z)); }));
}

TEST_CASE("uniform directions follow their density") {
    check(chi_square_of_directions([](float, Vec2 u) { return sample_uniform_sphere(u); },
                                   [](Vec3) { return static_cast<double>(pdf_uniform_sphere()); }));
    check(
        chi_square_of_directions([](float, Vec2 u) { return sample_uniform_hemisphere(u); },
                                 [](Vec3 w) { return w.z > 0 ? static_cast<double>(pdf_uniform_hemisphere()) : 0.0; }));
}

TEST_CASE("cones follow their density, wide and narrow") {
    for (const float one_minus_cos : {1.5f, 0.2f, 1e-3f}) {
        // A narrow cone is one cell of the sphere's grid, so the grid covers the cone: the azimuth about z, and |w -
        // z|^2 = 2 (1 - cos) relative to its largest value, which is uniform in solid angle.
        const auto sample = [&](Vec2 u) {
            const Vec3 w = sample_uniform_cone(u, one_minus_cos);
            const float turns = std::atan2(w.y, w.x) / kTwoPi;
            return Vec2{turns < 0 ? turns + 1 : turns,
                        min(length_squared(w - Vec3{0, 0, 1}) / (2 * one_minus_cos), 1.0f)};
        };
        const double density = 6.283185307179586 * static_cast<double>(one_minus_cos * pdf_uniform_cone(one_minus_cos));
        check(chi_square_of_points(sample, [&](Vec2) { return density; }, {0, 0}, {1, 1}));
    }
}

TEST_CASE("the chi-square test refuses a density that is tilted by 5 % or scaled by 0.1 %") {
    const auto sample = [](float, Vec2 u) -> std::optional<Vec3> { return sample_uniform_sphere(u); };
    CHECK(!chi_square_of_directions(sample, [](Vec3 w) {
               return 0.0795774715 * (1 + 0.05 * static_cast<double>(w.z));
           }).passes(kWarpTests));
    CHECK(!chi_square_of_directions(sample, [](Vec3) { return 0.0795774715 * 1.001; }).passes(kWarpTests));
    CHECK(!chi_square_of_directions(sample, [](Vec3) { return 0.0795774715 * 0.999; }).passes(kWarpTests));
    const auto failing = [&](float lobe, Vec2 u) { return lobe < 0.001f ? std::nullopt : sample(lobe, u); };
    CHECK(chi_square_of_directions(failing, [](Vec3) { return 0.0795774715 * 0.999; }).passes(kWarpTests));
}

TEST_CASE("the incomplete gamma function matches known values") {
    CHECK(test::upper_gamma(1, 2) == doctest::Approx(std::exp(-2.0)).epsilon(1e-12));
    CHECK(test::upper_gamma(0.5, 0.25) == doctest::Approx(std::erfc(0.5)).epsilon(1e-12));
    CHECK(test::upper_gamma(0.5, 9) == doctest::Approx(std::erfc(3.0)).epsilon(1e-12));
    CHECK(test::upper_gamma(400, 400) == doctest::Approx(0.49335).epsilon(1e-4)); // near 1/2 - 1/(3 sqrt(2 pi a))
}

TEST_CASE("points on the disk are uniform") {
    check(chi_square_of_points([](Vec2 u) { return sample_uniform_disk_concentric(u); }, inside_disk, {-1, -1}, {1, 1},
                               {.cells_x = 30, .cells_y = 30}));
}

TEST_CASE("points on regular polygons are uniform") {
    for (const auto& [sides, turn] : {std::pair(3, 0.1), std::pair(7, 0.975)}) {
        const RegularPolygon polygon = regular_polygon(sides, turn);
        check(chi_square_of_points([&](Vec2 u) { return sample_regular_polygon(polygon, u); },
                                   PolygonDensity(sides, turn), {-1, -1}, {1, 1},
                                   {.samples = 200'000, .cells_x = 30, .cells_y = 30}));
    }
}

TEST_CASE("points on the triangle are uniform") {
    check(chi_square_of_points([](Vec2 u) { return sample_uniform_triangle(u); },
                               [](Vec2 p) { return p.x + p.y <= 1 ? 2.0 : 0.0; }, {0, 0}, {1, 1}, {.cells_y = 40}));
}

TEST_CASE("the tent filter follows its density") {
    const auto sample = [](Vec2 u) { return Vec2{sample_tent(u.x), sample_tent(u.y)}; };
    check(chi_square_of_points(sample, [](Vec2 p) { return static_cast<double>(pdf_tent(p.x) * pdf_tent(p.y)); },
                               {-1, -1}, {1, 1}, {.cells_y = 40}));
}

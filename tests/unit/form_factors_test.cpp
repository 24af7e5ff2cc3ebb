// Form factors by rays and by hemicubes against closed forms, and their invariants.

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "tests/support/radiosity_scenes.h"

using namespace pertev;

namespace {

/// Form factor from a square of side 1 to one of the same size at distance `c`, face to face (Howell, "A Catalog of
/// Radiation Heat Transfer Configuration Factors", C-11).
double parallel_squares(double c) {
    const double x = 1 / c, r = std::sqrt(1 + x * x);
    return 2 / (std::numbers::pi * x * x) *
           (0.5 * std::log((1 + x * x) * (1 + x * x) / (1 + 2 * x * x)) + 2 * x * r * std::atan(x / r) -
            2 * x * std::atan(x));
}

/// Form factor from a square to one that stands on its edge (Howell, C-14).
double standing_squares() {
    const double root = std::sqrt(2.0);
    return (2 * std::atan(1.0) - root * std::atan(1 / root) + 0.25 * std::log(4.0 / 3 * 0.75 * 0.75)) /
           std::numbers::pi;
}

Scene squares(bool is_parallel) {
    Scene scene;
    test::add(scene, test::sheet({0, 0, 0}, {0, 0, 0.5f}, {0.5f, 0, 0}), test::white(0.5f)); // faces up
    test::add(scene,
              is_parallel ? test::sheet({0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f})
                          : test::sheet({-0.5f, 0.5f, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}),
              test::white(0.5f));
    return scene;
}

double sum_of(const FormFactorRow& row) {
    double sum = 0;
    for (const FormFactor& factor : row.factors) sum += static_cast<double>(factor.factor);
    return sum;
}

} // namespace

TEST_CASE("rays find the form factors of squares to 1e-4") {
    CHECK(parallel_squares(1) == doctest::Approx(0.199825).epsilon(1e-5));
    CHECK(standing_squares() == doctest::Approx(0.200044).epsilon(1e-5));
    for (const bool is_parallel : {true, false}) {
        const double known = is_parallel ? parallel_squares(1) : standing_squares();
        const test::PatchedScene patched(squares(is_parallel), 0.4f); // 32 patches a side of a square
        const auto rows = patched.rows({.rays = 1u << 16});
        const double there = patched.factor(rows, 0, 0, 1), back = patched.factor(rows, 1, 0, 0);
        CAPTURE(there);
        CAPTURE(back);
        CHECK(std::abs(there - known) < 1e-4);
        CHECK(std::abs(back - known) < 1e-4);
        CHECK(patched.factor(rows, 0, 1, 1) == 0); // the back receives nothing
    }
}

TEST_CASE("hemicubes of 128 pixels find the form factors of squares to 1 %") {
    for (const bool is_parallel : {true, false}) {
        const double known = is_parallel ? parallel_squares(1) : standing_squares();
        const test::PatchedScene patched(squares(is_parallel), 0.1f); // 512 patches a side: a hemicube each
        const auto rows = patched.rows({.hemicube = 128, .form_factors = FormFactors::Hemicube});
        const double there = patched.factor(rows, 0, 0, 1);
        CAPTURE(there);
        CHECK(there == doctest::Approx(known).epsilon(0.01));
        CHECK(patched.factor(rows, 0, 1, 1) == 0);
    }
}

TEST_CASE("a hemicube's pixels cover the cosine-weighted hemisphere") {
    for (const uint32_t resolution : {8u, 64u, 130u}) {
        const HemicubePixels pixels(resolution);
        const Frame frame = make_frame(normalize(Vec3{1, 2, -3}));
        double sum = 0, upwards = 0;
        for (uint32_t number = 0; number < HemicubePixels::kFaces; ++number) {
            const HemicubePixels::Face face = pixels.face(frame, number);
            CHECK(std::abs(dot(face.forward, face.up)) < 1e-6f);
            CHECK(dot(cross(face.right, face.up), face.right) < 1e-6f);
            for (uint32_t i = 0; i < face.width * face.height; ++i) {
                const auto x = static_cast<float>(pixel_coordinate(i % face.width, face.width, -1, 2));
                const auto y =
                    static_cast<float>(pixel_coordinate(i / face.width, face.height, face.lowest, 1 - face.lowest));
                const Vec3 direction = normalize(face.forward + x * face.right + y * face.up);
                const float cosine = dot(direction, frame.normal);
                CHECK(cosine > 0);
                sum += static_cast<double>(face.shares[i]);
                upwards += static_cast<double>(face.shares[i] * cosine);
            }
        }
        CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        CHECK(upwards == doctest::Approx(2.0 / 3).epsilon(0.02)); // cosine-weighted mean of the cosine
    }
}

TEST_CASE("form factors of a closed room sum to 1, whatever it contains") {
    Scene scene = test::closed_box(test::white(0.5f));
    test::add(scene, test::sheet({0, 0.9f, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}),
              test::emitter_material(0.2f, 5)); // faces down
    const test::PatchedScene patched(std::move(scene), 0.8f);
    for (const FormFactors method : {FormFactors::Rays, FormFactors::Hemicube}) {
        const auto rows = patched.rows({.rays = 256, .hemicube = 32, .form_factors = method});
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Patch& patch = patched.tree.patches[i];
            CHECK(std::ranges::is_sorted(rows[i].factors, {}, &FormFactor::patch));
            if (patch.instance < 6 && patch.side() == 1) {
                CHECK(rows[i].factors.empty()); // the outer faces receive nothing
            } else {
                CHECK(sum_of(rows[i]) == doctest::Approx(1).epsilon(1e-5));
            }
            for (const FormFactor& factor : rows[i].factors) {
                CHECK(factor.patch != i); // a flat patch receives nothing from itself
                CHECK(factor.factor > 0);
            }
        }
    }
}

TEST_CASE("few rays find the form factor of an emitter") {
    Scene scene;
    test::add(scene, test::floor_at(0, 0.05f), test::white(0.5f));
    const float half = 0.1f;
    test::add(scene, test::sheet({0, 2, 0}, {half, 0, 0}, {0, 0, half}), test::emitter_material(0, 1)); // faces down
    const test::PatchedScene patched(std::move(scene), 10);
    const auto rows = patched.rows({.rays = 64});
    // For a small, distant emitter the form factor is its area over pi times the squared distance. One ray in 314 would
    // hit it.
    const double known = 4.0 * 0.01 / (std::numbers::pi * 4);
    CHECK(patched.factor(rows, 0, 0, 1) == doctest::Approx(known).epsilon(0.02));
}

TEST_CASE("light that both kinds of rays find counts once") {
    Scene scene;
    test::add(scene, test::floor_at(0, 0.02f), test::white(0.5f));
    test::add(scene, test::sheet({0, 1, 0}, {1, 0, 0}, {0, 0, 1}), test::emitter_material(0, 1)); // faces down
    const test::PatchedScene patched(std::move(scene), 10);
    const auto rows = patched.rows({.rays = 4096});
    // The form factor from a point to a parallel square twice as wide as its distance (Howell, B-4); each kind of ray
    // finds half of the light.
    const double root = std::sqrt(0.5), known = 4 * root * std::atan(root) / std::numbers::pi;
    CHECK(known == doctest::Approx(0.55413).epsilon(1e-4));
    CHECK(patched.factor(rows, 0, 0, 1) == doctest::Approx(known).epsilon(0.01));
}

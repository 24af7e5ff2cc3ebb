// Samples of each pixel filter against its formula, which is repeated here in double precision. The expected counts of
// cells of equal width are integrals of the formula.

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "render/pixel_filter.h"
#include "tests/support/chi_square.h"
#include "tests/support/meshes.h"

using namespace pertev;

namespace {

/// Returns the filter's value at x in [-1, 1], in radii. It is not normalised.
double formula(PixelFilter filter, double x) {
    switch (filter) {
    case PixelFilter::Box:
        return 1;
    case PixelFilter::Tent:
        return 1 - std::abs(x);
    case PixelFilter::Gaussian:
        return std::exp(-x * x / (2.0 / 9)); // the standard deviation is a third of the radius
    case PixelFilter::BlackmanHarris: {
        const double phase = 3.14159265358979323846 * (x + 1);
        return 0.35875 - 0.48829 * std::cos(phase) + 0.14128 * std::cos(2 * phase) - 0.01168 * std::cos(3 * phase);
    }
    }
    return 0;
}

/// Returns the integral of `f` over [a, b] by the midpoint rule.
double integral(const std::function<double(double)>& f, double a, double b, int steps = 2000) {
    double sum = 0;
    for (int i = 0; i < steps; ++i) sum += f(a + (i + 0.5) / steps * (b - a));
    return sum * (b - a) / steps;
}

struct Filter {
    explicit Filter(PixelFilter kind, float radius)
        : table(make_filter_table(kind)), view{kind, radius, table.empty() ? nullptr : table.data()} {}
    std::vector<float> table;
    PixelFilterView view;
};

constexpr PixelFilter kFilters[] = {PixelFilter::Box, PixelFilter::Tent, PixelFilter::Gaussian,
                                    PixelFilter::BlackmanHarris};

} // namespace

TEST_CASE("samples of a pixel filter pass a chi-square test of its formula along an axis") {
    constexpr int cells = 101, samples = 1'000'000; // odd: the middle cell holds the table's steepest part
    for (const PixelFilter kind : kFilters) {
        CAPTURE(static_cast<int>(kind));
        const Filter filter(kind, 1.75f);
        test::Random random(11);
        std::vector<double> observed(cells), expected(cells);
        for (int i = 0; i < samples; ++i) {
            const float x = sample_filter_axis(filter.view, random.unit()) / 1.75f;
            REQUIRE(std::abs(x) <= 1);
            ++observed[static_cast<std::size_t>(to_int((x + 1) * 0.5f * cells, 0, cells - 1))];
        }
        const auto f = [&](double x) { return formula(kind, x); };
        const double whole = integral(f, -1, 0) + integral(f, 0, 1);
        for (int i = 0; i < cells; ++i) {
            expected[static_cast<std::size_t>(i)] =
                samples / whole * integral(f, 2.0 * i / cells - 1, 2.0 * (i + 1) / cells - 1, 200);
        }
        const test::ChiSquareResult result = test::chi_square(observed, expected);
        CHECK_MESSAGE(result.passes(4), result.describe());
    }
}

TEST_CASE("a pixel filter's mean is the pixel's centre, and its variance is that of the formula") {
    for (const PixelFilter kind : kFilters) {
        CAPTURE(static_cast<int>(kind));
        const float radius = default_filter_radius(kind);
        const Filter filter(kind, radius);
        constexpr int count = 1 << 16; // the samples divide [0, 1] evenly, so the mean has no noise
        double sum = 0, square_sum = 0;
        for (int i = 0; i < count; ++i) {
            const auto x = static_cast<double>(
                sample_filter_axis(filter.view, (static_cast<float>(i) + 0.5f) / static_cast<float>(count)));
            sum += x;
            square_sum += x * x;
        }
        const double variance = integral([&](double x) { return x * x * formula(kind, x); }, -1, 1) /
                                integral([&](double x) { return formula(kind, x); }, -1, 1) * double(radius) *
                                double(radius);
        CHECK(std::abs(sum / count) < 1e-5);
        CHECK(square_sum / count == doctest::Approx(variance).epsilon(2e-3));
    }
}

TEST_CASE("a pixel filter's samples grow with u, are symmetric and stay inside the radius") {
    for (const PixelFilter kind : kFilters) {
        CAPTURE(static_cast<int>(kind));
        const Filter filter(kind, 2.0f);
        float last = -2.0f;
        for (int i = 0; i < 1 << 14; ++i) {
            const float u = (static_cast<float>(i) + 0.5f) / static_cast<float>(1 << 14);
            const float x = sample_filter_axis(filter.view, u);
            CHECK(x >= last);
            CHECK(std::abs(x) <= 2.0f);
            CHECK(std::abs(x + sample_filter_axis(filter.view, 1.0f - u)) < 2e-5f);
            last = x;
        }
        CHECK(sample_filter_axis(filter.view, 0x1.fffffep-1f) <= 2.0f);
    }
}

TEST_CASE("each axis of a pixel filter uses one random number") {
    for (const PixelFilter kind : kFilters) {
        const Filter filter(kind, 1.5f);
        const Vec2 offset = sample_filter(filter.view, {0.2f, 0.9f});
        CHECK(offset.x == sample_filter_axis(filter.view, 0.2f));
        CHECK(offset.y == sample_filter_axis(filter.view, 0.9f));
    }
}

TEST_CASE("only filters without a closed form have a table, which covers the radius on both sides") {
    CHECK(make_filter_table(PixelFilter::Box).empty());
    CHECK(make_filter_table(PixelFilter::Tent).empty());
    for (const PixelFilter kind : {PixelFilter::Gaussian, PixelFilter::BlackmanHarris}) {
        const std::vector<float> table = make_filter_table(kind);
        REQUIRE(table.size() == kFilterTableSize + 1);
        CHECK(table.front() == doctest::Approx(-1).epsilon(1e-3));
        CHECK(table.back() == 1.0f);
        CHECK(std::abs(table[kFilterTableSize / 2]) < 1e-6f);
    }
}

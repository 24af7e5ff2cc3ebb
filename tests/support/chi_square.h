#pragma once

// Chi-square test of samples against a density, for warps and BSDFs: draws samples, counts them in a grid of cells, and
// compares with the integral of the density over each cell. Cells with small expected counts are pooled. The missing
// part of the density's integral and rejected samples form another cell, so a density of the wrong scale fails, too.
//
// Source: Pearson's test; the pooling and the correction for many tests as in Mitsuba's chi2 (Jakob).

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev::test {

struct ChiSquareResult {
    double statistic = 0;
    int degrees_of_freedom = 0;
    double p_value = 1;     // the probability of a statistic at least as large if the samples follow the density
    double integral = 0;    // integral of the density over the whole grid
    std::string worst_cell; // the cell with the largest difference, for the failure's message

    /// Returns false if the difference is significant at level 0.01 for the worst of `tests` tests (Sidak).
    bool passes(int tests) const;
    std::string describe() const;
};

/// Upper regularised incomplete gamma function Q(a, x), a > 0, x >= 0.
double upper_gamma(double a, double x);

/// Computes chi-square over counted cells; `expected` counts have the same total up to rounding. Cells are pooled from
/// the rarest until each has 5 expected. A cell that expects nothing and has a sample makes p_value 0.
ChiSquareResult chi_square(std::span<const double> observed, std::span<const double> expected);

struct ChiSquareSettings {
    uint32_t samples = 1'000'000;
    uint32_t seed = 1;
    int cells_x = 40, cells_y = 20; // along phi and cos(theta) of a sphere, or along x and y of a rectangle
    int min_quarterings = 2;        // the minimum per cell, so that no narrow peak is missed
    int max_quarterings = 6; // the maximum; the error along a discontinuity must be a small part of a cell's deviation
};

/// Tests directions. `sample(lobe, u)` returns a unit vector or nothing (the sample failed), for independent uniform
/// lobe in (0, 1) and u in (0, 1)^2; `pdf(w)` its density by solid angle, over the whole sphere about the z axis.
ChiSquareResult chi_square_of_directions(const std::function<std::optional<Vec3>(float lobe, Vec2 u)>& sample,
                                         const std::function<double(Vec3)>& pdf,
                                         const ChiSquareSettings& settings = {});

/// Tests points of the rectangle [lo, hi]; a point outside counts as failed.
ChiSquareResult chi_square_of_points(const std::function<Vec2(Vec2 u)>& sample, const std::function<double(Vec2)>& pdf,
                                     Vec2 lo, Vec2 hi, const ChiSquareSettings& settings = {});

} // namespace pertev::test

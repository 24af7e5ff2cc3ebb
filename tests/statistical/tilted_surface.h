#pragma once

// A surface whose interpolated normal differs from its triangle's normal, and a test of its sampling.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>

#include "device_scene/surface.h"
#include "tests/support/chi_square.h"
#include "tests/support/options.h"

namespace pertev::test {

/// A surface with the shading normal +z and a triangle that is rotated by asin(tilt) about y.
inline Surface tilted_surface(const Bsdf& bsdf, float tilt) {
    Surface surface = {};
    surface.geometric_normal = {tilt, 0, std::sqrt(1.0f - tilt * tilt)};
    surface.frame = make_frame(Vec3{0, 0, 1});
    surface.bsdf = bsdf;
    surface.tilt = terminator_tilt(tilt, 0);
    return surface;
}

struct TiltedSampling {
    ChiSquareResult directions;
    double weight_error; // the largest relative error of weight times pdf against the value
};

/// Compares the directions that `sample` draws with the density that `evaluate` returns, and their weights with its
/// values.
inline TiltedSampling test_tilted_sampling(const std::function<BsdfSample(float lobe, Vec2 u)>& sample,
                                           const std::function<BsdfValue(Vec3 direction)>& evaluate) {
    double weight_error = 0;
    const auto direction = [&](float lobe, Vec2 u) -> std::optional<Vec3> {
        const BsdfSample s = sample(lobe, u);
        if (!(s.pdf > 0) || s.is_delta()) return std::nullopt;
        const double f = static_cast<double>(evaluate(s.wi).f.g);
        weight_error = std::max(weight_error, std::abs(static_cast<double>(s.weight.g * s.pdf) - f) / f);
        return s.wi;
    };
    const auto pdf = [&](Vec3 w) { return static_cast<double>(evaluate(w).pdf); };
    // 96 cells notice from 16,000 samples what 240 notice from 25,000, and cost a fifth of the integrals.
    ChiSquareSettings settings = {
        .samples = 16'000, .cells_x = 8, .cells_y = 12, .min_quarterings = 0, .max_quarterings = 5};
    if (effort(0, 1) != 0) settings = {.samples = 400'000, .cells_x = 12, .cells_y = 20, .min_quarterings = 1};
    const ChiSquareResult directions = chi_square_of_directions(direction, pdf, settings);
    return {directions, weight_error};
}

} // namespace pertev::test

#pragma once

// One equation of a radiosity system: what a patch receives. Its irradiance is what comes from outside, from lights
// that are no patches, and the sum over patches j of factor_j times their radiosity.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/rgb.h"

namespace pertev {

struct FormFactor {
    uint32_t patch; // that light comes from
    float factor;   // F from the row's patch to it: the share of the hemisphere, by cosine, that it covers
};

inline constexpr std::size_t kOfAllocation = 16; // bytes that an allocator adds to each row that is kept

/// By ascending patch, each once; together 1 at most.
struct FormFactorRow {
    std::vector<FormFactor> factors;
    Rgb direct; // irradiance by point, spot and directional lights and the environment, W/m2

    void clear() {
        factors.clear();
        direct = {};
    }
    /// Adds up those of one patch, and puts them in order.
    void sort();
};

/// Irradiance by what all patches send, `radiosity` [patches], W/m2. A tree_sum in double.
Rgb gather(std::span<const FormFactor> row, const std::vector<Rgb>& radiosity);

} // namespace pertev

#pragma once

// One row of a radiosity system. A patch's irradiance is direct light from lights that are no patches, plus the sum
// over patches j of factor_j times their radiosity.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/rgb.h"

namespace pertev {

struct FormFactor {
    uint32_t patch; // the sending patch
    float factor;   // F from the row's patch to it: the cosine-weighted share of the hemisphere that it covers
};

inline constexpr std::size_t kOfAllocation = 16; // overhead of an allocator per stored row

/// Form factors by ascending patch, without duplicates; their sum is at most 1.
struct FormFactorRow {
    std::vector<FormFactor> factors;
    Rgb direct; // irradiance by point, spot and directional lights and the environment, W/m2

    void clear() {
        factors.clear();
        direct = {};
    }
    /// Merges the factors of each patch and sorts them.
    void sort();
};

/// Irradiance from all patches with `radiosity` [patches], W/m2. A tree_sum in double.
Rgb gather(std::span<const FormFactor> row, const std::vector<Rgb>& radiosity);

} // namespace pertev

#pragma once

// Finds the cheapest split of a row of boxes by the surface area heuristic, with every position tried.

#include <cstdint>

#include "math/bounds3.h"

namespace pertev {

struct SweepCut {
    float cost = kInfinity; // sum of half area times count over both sides
    float uncut = 0;        // cost without a split, in the same unit
    uint32_t left = 0;      // number of boxes before the split

    /// Returns whether the cut costs less than none, by more than rounding. If all boxes are equal, costs differ only
    /// by rounding, and following that would give a chain.
    bool gains() const { return cost < uncut * (1 - 0x1p-20f); }
};

/// Returns the first of the cheapest splits. `box_at(i)` is the i-th of `count` boxes, at least two. `right_area` has
/// room for `count` floats.
template <class BoxAt>
SweepCut find_sweep_cut(uint32_t count, const BoxAt& box_at, float* right_area) {
    Bounds3 box;
    for (uint32_t i = count; i-- > 0;) {
        box.extend(box_at(i));
        right_area[i] = box.half_area();
    }
    SweepCut best;
    best.uncut = right_area[0] * static_cast<float>(count);
    box = {};
    for (uint32_t i = 1; i < count; ++i) {
        box.extend(box_at(i - 1));
        const float cost = box.half_area() * static_cast<float>(i) + right_area[i] * static_cast<float>(count - i);
        if (cost < best.cost) best.cost = cost, best.left = i;
    }
    return best;
}

} // namespace pertev

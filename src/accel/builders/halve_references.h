#pragma once

// Splits references at the object median along the axis with the largest extent of centres.

#include <algorithm>
#include <span>

#include "accel/builders/binary_tree.h"

namespace pertev {

/// Doubled centre of the box; the factor does not matter here.
inline Vec3 centre_of(const BuildReference& r) { return r.lo + r.hi; }

inline Bounds3 centres_of(std::span<const BuildReference> references) {
    Bounds3 centres;
    for (const BuildReference& r : references) centres.extend(centre_of(r));
    return centres;
}

/// Strict order along an axis; ids break ties between equal centres.
inline bool lies_before(const BuildReference& a, const BuildReference& b, int axis) {
    const float ca = component(a.lo, axis) + component(a.hi, axis), cb = component(b.lo, axis) + component(b.hi, axis);
    return ca != cb ? ca < cb : a.id < b.id;
}

/// Moves the references before the median to the front and returns their number.
inline uint32_t halve_references(std::span<BuildReference> references, const Bounds3& centres) {
    const int axis = longest_axis(centres);
    const std::size_t middle = references.size() / 2;
    std::nth_element(references.begin(), references.begin() + static_cast<std::ptrdiff_t>(middle), references.end(),
                     [axis](const BuildReference& a, const BuildReference& b) { return lies_before(a, b, axis); });
    return static_cast<uint32_t>(middle);
}

} // namespace pertev

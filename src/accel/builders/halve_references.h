#pragma once

// Cuts references in two at the middle of their number, along the axis where their centres spread most.

#include <algorithm>
#include <span>

#include "accel/builders/binary_tree.h"

namespace pertev {

/// Twice the centre: nothing here needs the half.
inline Vec3 centre_of(const BuildReference& r) { return r.lo + r.hi; }

inline Bounds3 centres_of(std::span<const BuildReference> references) {
    Bounds3 centres;
    for (const BuildReference& r : references) centres.extend(centre_of(r));
    return centres;
}

/// The order along an axis; the id decides between equal centres, so that it is one.
inline bool lies_before(const BuildReference& a, const BuildReference& b, int axis) {
    const float ca = component(a.lo, axis) + component(a.hi, axis), cb = component(b.lo, axis) + component(b.hi, axis);
    return ca != cb ? ca < cb : a.id < b.id;
}

/// Brings those before the middle to the front; returns how many those are.
inline uint32_t halve_references(std::span<BuildReference> references, const Bounds3& centres) {
    const int axis = longest_axis(centres);
    const std::size_t middle = references.size() / 2;
    std::nth_element(references.begin(), references.begin() + static_cast<std::ptrdiff_t>(middle), references.end(),
                     [axis](const BuildReference& a, const BuildReference& b) { return lies_before(a, b, axis); });
    return static_cast<uint32_t>(middle);
}

} // namespace pertev

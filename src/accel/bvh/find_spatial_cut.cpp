#include "accel/bvh/find_spatial_cut.h"

#include "accel/bvh/cut_triangle.h"

namespace pertev {
namespace {

constexpr int kMinBins = 8, kMaxBins = 32;

struct Bin {
    Bounds3 box;
    uint64_t begins = 0, ends = 0; // how many references have their first and their last part here
};

/// Planes between bins; false where there is no room for them.
bool place_planes(float lo, float hi, int bins, float* planes) {
    for (int k = 0; k <= bins; ++k) {
        const float part = static_cast<float>(k) / static_cast<float>(bins);
        planes[k] = k < bins ? lo + part * (hi - lo) : hi;
        if (k > 0 && !(planes[k - 1] < planes[k])) return false;
    }
    return true;
}

} // namespace

SpatialCut find_spatial_cut(std::span<const BuildReference> references, const std::vector<BvhTriangle>& triangles,
                            const Bounds3& box, int axis, uint64_t allowance) {
    const float lo = component(box.lo, axis), hi = component(box.hi, axis);
    // As many as references: most nodes are small, and in those a triangle reaches through most bins.
    const int bin_count = to_int(static_cast<float>(references.size()), kMinBins, kMaxBins);
    float planes[kMaxBins + 1];
    if (!place_planes(lo, hi, bin_count, planes)) return {};
    const float scale = static_cast<float>(bin_count) / (hi - lo);
    if (!is_finite(scale)) return {};

    Bin bins[kMaxBins];
    for (const BuildReference& r : references) {
        const int first = to_int((component(r.lo, axis) - lo) * scale, 0, bin_count - 1);
        const int last = to_int((component(r.hi, axis) - lo) * scale, first, bin_count - 1);
        Bounds3 rest = {r.lo, r.hi};
        for (int k = first; k < last && !rest.is_empty(); ++k) {
            const ClippedBoxes parts = cut_triangle(triangles[r.id], rest, axis, planes[k + 1]);
            bins[k].box.extend(parts.left); // an empty box adds nothing
            rest = parts.right;
        }
        bins[last].box.extend(rest);
        ++bins[first].begins;
        ++bins[last].ends;
    }

    Bounds3 right[kMaxBins]; // of bins from here on
    Bounds3 sum;
    for (int k = bin_count - 1; k > 0; --k) {
        sum.extend(bins[k].box);
        right[k] = sum;
    }
    SpatialCut best, at;
    at.right_size = references.size();
    for (int k = 1; k < bin_count; ++k) {
        at.left.extend(bins[k - 1].box);
        at.left_size += bins[k - 1].begins;
        at.right_size -= bins[k - 1].ends;
        if (at.left_size == 0 || at.right_size == 0) continue;
        if (at.left_size + at.right_size - references.size() > allowance) continue;
        at.cost = at.left.half_area() * static_cast<float>(at.left_size) +
                  right[k].half_area() * static_cast<float>(at.right_size);
        if (!(at.cost < best.cost)) continue;
        best = at;
        best.right = right[k];
        best.plane = planes[k];
    }
    return best;
}

} // namespace pertev

#pragma once

// Bins boxes along three axes with four SIMD lanes and finds the cheapest split between bins.
//
// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE RT 2007, section 3.

#include <immintrin.h>

#include <bit>
#include <cstdint>

#include "accel/bvh/build_tree.h"
#include "math/bounds3.h"

namespace pertev {

inline constexpr int kMaxBins = 64;

/// Box with x, y, z in three lanes; the fourth lane is 0 or ignored.
struct Box4 {
    __m128 lo = _mm_set1_ps(kInfinity), hi = _mm_set1_ps(-kInfinity);

    void extend(const Box4& b) {
        lo = _mm_min_ps(lo, b.lo);
        hi = _mm_max_ps(hi, b.hi);
    }
    void extend_point(__m128 p) {
        lo = _mm_min_ps(lo, p);
        hi = _mm_max_ps(hi, p);
    }
};

inline float half_area(const Box4& b) {
    const __m128 d = _mm_sub_ps(b.hi, b.lo);
    const __m128 p = _mm_mul_ps(d, _mm_shuffle_ps(d, d, _MM_SHUFFLE(3, 0, 2, 1))); // xy, yz, zx
    return _mm_cvtss_f32(p) + _mm_cvtss_f32(_mm_shuffle_ps(p, p, 1)) + _mm_cvtss_f32(_mm_shuffle_ps(p, p, 2));
}

inline Bounds3 to_bounds(const Box4& b) {
    alignas(16) float lo[4], hi[4];
    _mm_store_ps(lo, b.lo);
    _mm_store_ps(hi, b.hi);
    return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}};
}

inline Box4 simd_box_of(const BuildReference& r) {
    const __m128 xyz = _mm_castsi128_ps(_mm_setr_epi32(-1, -1, -1, 0)); // the id may be denormal when read as a float
    return {_mm_and_ps(xyz, _mm_load_ps(&r.lo.x)), _mm_load_ps(&r.hi.x)};
}
inline __m128 centre_of(const Box4& b) {
    return _mm_add_ps(b.lo, b.hi);
} // doubled centre; the factor does not matter here

/// Bins along three axes. Most nodes have fewer boxes than bins, so only as many bins are cleared as are used, and cuts
/// skip the empty ones.
class Bins {
public:
    /// Makes `bins` empty bins for each axis; there are no others.
    explicit Bins(int bins) {
        const Box4 empty;
        for (int axis = 0; axis < 3; ++axis)
            for (int k = 0; k < bins; ++k) lo_[axis][k] = empty.lo, hi_[axis][k] = empty.hi, count_[axis][k] = 0;
    }

    void add(int axis, int bin, const Box4& box, uint32_t count) {
        lo_[axis][bin] = _mm_min_ps(lo_[axis][bin], box.lo), hi_[axis][bin] = _mm_max_ps(hi_[axis][bin], box.hi);
        count_[axis][bin] += count;
        occupied_[axis] |= uint64_t(1) << bin;
    }
    /// The occupied bins of an axis, a bit each.
    uint64_t occupied(int axis) const { return occupied_[axis]; }
    Box4 box(int axis, int bin) const { return {lo_[axis][bin], hi_[axis][bin]}; }
    uint32_t count(int axis, int bin) const { return count_[axis][bin]; }

private:
    __m128 lo_[3][kMaxBins], hi_[3][kMaxBins];
    uint32_t count_[3][kMaxBins];
    uint64_t occupied_[3] = {};
};

/// Calls use(bin) for the bits of a set of bins, upwards.
template <class Use>
void for_each_bin(uint64_t set, const Use& use) {
    for (; set != 0; set &= set - 1) use(std::countr_zero(set));
}

/// Maps a box to its bin along all axes at once. An axis along which the centres do not differ has only bin 0.
struct BinMap {
    __m128 first, scale;
    __m128i last;

    BinMap(const Box4& centres, int bins) : first(centres.lo), last(_mm_set1_epi32(bins - 1)) {
        const __m128 extent = _mm_sub_ps(centres.hi, centres.lo);
        const __m128 s = _mm_div_ps(_mm_set1_ps(static_cast<float>(bins) * 0.9999f), extent);
        // An extent that is 0, or so small that the quotient overflows, cannot be split.
        const __m128 usable =
            _mm_and_ps(_mm_cmpgt_ps(extent, _mm_setzero_ps()), _mm_cmplt_ps(s, _mm_set1_ps(0x1p126f)));
        scale = _mm_and_ps(s, usable);
    }
    __m128i operator()(const Box4& b) const {
        const __m128i k = _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(centre_of(b), first), scale));
        return _mm_max_epi32(_mm_min_epi32(k, last), _mm_setzero_si128());
    }
};

inline int lane(__m128i v, int axis) {
    alignas(16) int32_t k[4];
    _mm_store_si128(reinterpret_cast<__m128i*>(k), v);
    return k[axis];
}

struct BinnedCut {
    int axis = -1;          // -1 if there is none
    int bin = 0;            // boxes of a bin below go left
    float cost = kInfinity; // sum of half area times count over both sides
    Box4 left, right;
};

/// An empty bin moves no box, so only cuts right above an occupied one are tried.
inline BinnedCut find_cheapest_cut(const Bins& bins) {
    BinnedCut best;
    for (int axis = 0; axis < 3; ++axis) {
        const uint64_t occupied = bins.occupied(axis);
        float right_cost[kMaxBins]; // the cost of the boxes from an occupied bin on
        Box4 box;
        uint32_t n = 0;
        for (uint64_t rest = occupied; rest != 0;) {
            const int k = 63 - std::countl_zero(rest);
            rest ^= uint64_t(1) << k;
            box.extend(bins.box(axis, k));
            n += bins.count(axis, k);
            right_cost[k] = half_area(box) * static_cast<float>(n);
        }
        box = Box4{};
        n = 0;
        int below = -1;
        for_each_bin(occupied, [&](int k) {
            if (below >= 0) {
                const float cost = half_area(box) * static_cast<float>(n) + right_cost[k];
                if (cost < best.cost) best = {axis, below + 1, cost, {}, {}};
            }
            box.extend(bins.box(axis, k));
            n += bins.count(axis, k);
            below = k;
        });
    }
    if (best.axis < 0) return best;
    for_each_bin(bins.occupied(best.axis),
                 [&](int k) { (k < best.bin ? best.left : best.right).extend(bins.box(best.axis, k)); });
    return best;
}

/// Adds references [first, last) to the bins.
inline void fill_bins(const BuildReference* first, const BuildReference* last, const BinMap& map, Bins& bins) {
    for (; first != last; ++first) {
        const Box4 b = simd_box_of(*first);
        alignas(16) int32_t k[4];
        _mm_store_si128(reinterpret_cast<__m128i*>(k), map(b));
        for (int axis = 0; axis < 3; ++axis) bins.add(axis, k[axis], b, 1);
    }
}

/// Adds the bins of another set.
inline void add_bins(const Bins& part, Bins& sum) {
    for (int axis = 0; axis < 3; ++axis)
        for_each_bin(part.occupied(axis), [&](int k) { sum.add(axis, k, part.box(axis, k), part.count(axis, k)); });
}

} // namespace pertev

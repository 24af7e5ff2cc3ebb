#pragma once

// Bins boxes along three axes with four SIMD lanes and finds the cheapest split between bins.
//
// Source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", IEEE RT 2007, section 3.

#include <immintrin.h>

#include <algorithm>
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

struct Bins {
    Box4 box[3][kMaxBins];
    uint32_t count[3][kMaxBins];

    explicit Bins(int bins) {
        for (int axis = 0; axis < 3; ++axis) {
            std::fill_n(box[axis], bins, Box4{});
            std::fill_n(count[axis], bins, 0u);
        }
    }
};

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

inline BinnedCut find_cheapest_cut(const Bins& bins, int count) {
    BinnedCut best;
    for (int axis = 0; axis < 3; ++axis) {
        float right_cost[kMaxBins];
        Box4 box;
        uint32_t n = 0;
        for (int k = count - 1; k > 0; --k) {
            box.extend(bins.box[axis][k]);
            n += bins.count[axis][k];
            right_cost[k] = n == 0 ? kInfinity : half_area(box) * static_cast<float>(n);
        }
        box = Box4{};
        n = 0;
        for (int k = 1; k < count; ++k) {
            box.extend(bins.box[axis][k - 1]);
            n += bins.count[axis][k - 1];
            if (n == 0) continue;
            const float cost = half_area(box) * static_cast<float>(n) + right_cost[k];
            if (cost < best.cost) best = {axis, k, cost, {}, {}};
        }
    }
    if (best.axis >= 0) {
        for (int k = 0; k < best.bin; ++k) best.left.extend(bins.box[best.axis][k]);
        for (int k = best.bin; k < count; ++k) best.right.extend(bins.box[best.axis][k]);
    }
    return best;
}

/// Adds references [first, last) to the bins.
inline void fill_bins(const BuildReference* first, const BuildReference* last, const BinMap& map, Bins& bins) {
    for (; first != last; ++first) {
        const Box4 b = simd_box_of(*first);
        alignas(16) int32_t k[4];
        _mm_store_si128(reinterpret_cast<__m128i*>(k), map(b));
        for (int axis = 0; axis < 3; ++axis) {
            bins.box[axis][k[axis]].extend(b);
            ++bins.count[axis][k[axis]];
        }
    }
}

/// Adds the bins of another set, `count` per axis.
inline void add_bins(const Bins& part, int count, Bins& sum) {
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < count; ++k) {
            sum.box[axis][k].extend(part.box[axis][k]);
            sum.count[axis][k] += part.count[axis][k];
        }
    }
}

} // namespace pertev

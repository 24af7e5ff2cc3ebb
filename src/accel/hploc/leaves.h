#pragma once

// Makes leaves along a Morton curve from triangles: bounds of all centres, a code for each triangle and, after the
// sort, a box for each. The curve's cells are cubes, so that boxes of neighbours are as thick as they are long.

#include <cstdint>
#include <span>

#include "accel/bvh/bvh.h"
#include "accel/hploc/climb.h"
#include "base/host_device.h"
#include "base/sort_until.h"
#include "math/bounds3.h"
#include "math/morton_code.h"
#include "math/scalar.h"

namespace pertev::hploc {

/// Sorts leaves by code on the host; equal codes are sorted by number. `order` holds 0, 1, 2, ... before. `sink` may
/// end it.
inline void sort_along_curve(const uint64_t* codes, std::span<uint32_t> order, Sink& sink) {
    sort_until(order, sink,
               [codes](uint32_t a, uint32_t b) { return codes[a] != codes[b] ? codes[a] < codes[b] : a < b; });
}

/// Maps floats to integers of the same order, so that atomic minima find bounds; -0 comes before 0.
HD inline int32_t ordered(float x) {
    const auto bits = static_cast<int32_t>(bits_of(x));
    return bits ^ (bits >> 31 & 0x7fffffff);
}
HD inline float unordered(int32_t x) { return float_of(static_cast<uint32_t>(x ^ (x >> 31 & 0x7fffffff))); }

inline constexpr unsigned char kNothing = 0x7f; // every byte of empty OrderedBounds

/// Bounds that many threads extend; all bytes are kNothing while they are empty.
struct OrderedBounds {
    int32_t least[6]; // least x, y, z, -x, -y, -z

    HD Vec3 lo() const { return {unordered(least[0]), unordered(least[1]), unordered(least[2])}; }
    HD Vec3 hi() const { return {-unordered(least[3]), -unordered(least[4]), -unordered(least[5])}; }
};

HD inline void lower(int32_t* target, int32_t value) {
#if defined(__CUDA_ARCH__)
    if (value < *target) atomicMin(target, value); // an outdated read only costs an extra atomic operation
#else
    int32_t seen = __atomic_load_n(target, __ATOMIC_RELAXED);
    while (value < seen &&
           !__atomic_compare_exchange_n(target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
#endif
}

HD inline Bounds3 bounds_of(const BvhTriangle& t) {
    Bounds3 box;
    box.extend(t.a);
    box.extend(t.b);
    box.extend(t.c);
    return box;
}

/// Doubled centre of a box.
HD inline Vec3 centre_of(const Bounds3& box) { return box.lo + box.hi; }

HD inline BvhTriangle load_triangle(const BvhTriangle* at) {
#if defined(__CUDA_ARCH__)
    BvhTriangle value;
    for (int k = 0; k < 3; ++k) {
        reinterpret_cast<uint4*>(&value)[k] = __ldg(reinterpret_cast<const uint4*>(at) + k);
    }
    return value;
#else
    return *at;
#endif
}

inline constexpr uint32_t kTrianglesAtOnce = 8; // triangles per thread in the search for bounds

/// Finds the bounds of all centres; each thread reads every stride-th triangle.
struct FindBounds {
    const BvhTriangle* triangles;
    uint32_t count, stride;
    OrderedBounds* centres;

    HD void operator()(uint32_t thread) const {
        int32_t least[6];
        for (int32_t& x : least) x = 0x7f7f7f7f;
        for (uint32_t k = 0; k < kTrianglesAtOnce; ++k) {
            const uint64_t i = thread + static_cast<uint64_t>(k) * stride;
            if (i >= count) break;
            const Vec3 centre = centre_of(hploc::bounds_of(load_triangle(triangles + i)));
            const float values[6] = {centre.x, centre.y, centre.z, -centre.x, -centre.y, -centre.z};
            for (int v = 0; v < 6; ++v) least[v] = ordered(values[v]) < least[v] ? ordered(values[v]) : least[v];
        }
        for (int v = 0; v < 6; ++v) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
            const unsigned lanes = __activemask();
            const int of_warp = __reduce_min_sync(lanes, least[v]);
            if ((threadIdx.x & 31u) == static_cast<unsigned>(__ffs(static_cast<int>(lanes)) - 1))
                lower(centres->least + v, of_warp);
#else
            lower(centres->least + v, least[v]);
#endif
        }
    }
};

struct MakeCodes {
    const BvhTriangle* triangles;
    const OrderedBounds* centres;
    uint64_t* codes;
    uint32_t* order;

    HD void operator()(uint32_t i) const {
        const Vec3 lo = centres->lo();
        const float extent = max_component(centres->hi() - lo);
        const Vec3 from = centre_of(hploc::bounds_of(load_triangle(triangles + i))) - lo;
        const auto cell = [&](float x) {
            return spread_bits(
                static_cast<uint64_t>(to_int(extent > 0 ? x / extent * 0x1p21f : 0.0f, 0, (1 << 21) - 1)));
        };
        codes[i] = cell(from.x) << 2 | cell(from.y) << 1 | cell(from.z);
        order[i] = i;
    }
};

/// The stage that makes the leaves, one per call; leaf i is triangle order[i].
struct StoreLeaves {
    const BvhTriangle* triangles;
    const uint32_t* order;
    Climb climb;

    HD void operator()(uint32_t i) const {
        const uint32_t triangle = order[i];
        const Bounds3 box = hploc::bounds_of(load_triangle(triangles + triangle));
        climb.tree.nodes[i] = {box.lo, triangle, box.hi, kNone};
        climb.ends[i] = kNone;
        if (i == 0) climb.tree.nodes[climb.tree.count] = {{}, kNone, {}, kNone}; // this node is unused
    }
};

} // namespace pertev::hploc

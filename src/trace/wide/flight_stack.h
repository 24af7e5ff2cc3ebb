#pragma once

// The stack of a ray in traversals_in_flight.h. Its code does not branch on hits, because a misprediction costs as much
// as a quarter of a node. Entered children are pushed by one permutation of vectors, the nearest of them is found by a
// minimum over lanes, and a hit drops entries beyond it at once, so that a pop need not test them.

#include <immintrin.h>

#include <array>
#include <cstdint>

#include "math/scalar.h"
#include "trace/wide/traverse_wide.h"

namespace pertev {

/// Lanes of a mask in ascending or descending order, as bytes; the rest is 0.
struct LanesOfMask {
    std::array<uint64_t, 256> up, down;
};
inline constexpr LanesOfMask kLanesOfMask = [] {
    LanesOfMask lanes{};
    for (unsigned mask = 0; mask < 256; ++mask) {
        int n = 0, count = __builtin_popcount(mask);
        for (uint64_t k = 0; k < 8; ++k) {
            if (!(mask >> k & 1)) continue;
            lanes.up[mask] |= k << 8 * n;
            lanes.down[mask] |= k << 8 * (count - 1 - n);
            ++n;
        }
    }
    return lanes;
}();

/// Pending children of one ray, as arrays, so that vectors can be pushed. [0], a leaf without triangles at the first
/// triangle, ends the traversal.
class FlightStack {
public:
    FlightStack() : size_(1) { entry_[0] = -kInfinity, link_[0] = kLeafBit, count_[0] = 0; }

    /// Pushes the entered children; the last is the nearest, or the builder's first, or the farthest.
    template <TraversalOptions kOptions>
    [[gnu::always_inline]] void push(const WideBvhNode<kWideChildren>& node, const EnteredChildren& children,
                                     bool far_first) {
        const unsigned entered = children.mask();
        uint64_t lanes;
        if (far_first) { // equal for most rays in flight
            const unsigned farthest = farthest_of(children);
            const unsigned others = entered & ~(1u << farthest); // all of them if none is entered, because then it is
                                                                 // beyond the top
            lanes = kLanesOfMask.down[others] | uint64_t(farthest) << 8 * __builtin_popcount(others);
        } else if constexpr (kOptions.near_first) {
            const unsigned nearest = nearest_of(children);
            const unsigned others = entered & ~(1u << nearest);
            lanes = kLanesOfMask.up[others] | uint64_t(nearest) << 8 * __builtin_popcount(others);
        } else {
            lanes = kLanesOfMask.down[entered];
        }
        const int size = size_;
        put(size, lanes, children.entries, _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)),
            _mm256_load_si256(reinterpret_cast<const __m256i*>(node.count)));
        size_ = size + __builtin_popcount(entered);
    }
    [[gnu::always_inline]] WideEntry pop() {
        const int size = size_ - 1;
        size_ = size;
        return {entry_[size], link_[size], count_[size]};
    }
    /// Pops entries beyond `limit`.
    void shorten(float limit) {
        int kept = 0;
        const __m256 limits = _mm256_set1_ps(limit);
        for (int i = 0; i < size_; i += 8) {
            const __m256 entries = _mm256_loadu_ps(entry_ + i);
            const unsigned rest = size_ - i >= 8 ? 0xffu : (1u << (size_ - i)) - 1;
            const unsigned keep =
                rest & static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(entries, limits, _CMP_LE_OQ)));
            const __m256i links = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(link_ + i));
            const __m256i counts = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(count_ + i));
            put(kept, kLanesOfMask.up[keep], entries, links, counts);
            kept += __builtin_popcount(keep);
        }
        size_ = kept;
    }

private:
    static constexpr int kSize = kWideStackSize<kWideChildren> + 9; // [0], and the unused lanes of the last push

    /// The lane with the least entry, by its upper 16 bits; none is negative. Any lane if none is entered.
    [[gnu::always_inline]] static unsigned nearest_of(const EnteredChildren& children) {
        return min_lane(_mm_or_si128(keys_of(children), _mm_xor_si128(in_of(children), _mm_set1_epi32(-1))));
    }
    /// The lane with the greatest entry. If all are 0, it is lane 0, entered or not; push() leaves it out if it is
    /// not.
    [[gnu::always_inline]] static unsigned farthest_of(const EnteredChildren& children) {
        return min_lane(_mm_xor_si128(_mm_and_si128(keys_of(children), in_of(children)), _mm_set1_epi32(-1)));
    }
    [[gnu::always_inline]] static __m128i keys_of(const EnteredChildren& children) {
        const __m256i entries = _mm256_srli_epi32(_mm256_castps_si256(children.entries), 16);
        return _mm_packus_epi32(_mm256_castsi256_si128(entries), _mm256_extracti128_si256(entries, 1));
    }
    [[gnu::always_inline]] static __m128i in_of(const EnteredChildren& children) {
        const __m256i is_in = _mm256_castps_si256(children.is_in);
        return _mm_packs_epi32(_mm256_castsi256_si128(is_in), _mm256_extracti128_si256(is_in, 1));
    }
    [[gnu::always_inline]] static unsigned min_lane(__m128i keys) {
        return static_cast<unsigned>(_mm_cvtsi128_si32(_mm_minpos_epu16(keys))) >> 16;
    }

    /// Writes the listed lanes from index `at` on; elements after them are overwritten too.
    [[gnu::always_inline]] void put(int at, uint64_t lanes, __m256 entries, __m256i links, __m256i counts) {
        const __m256i order = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(lanes)));
        _mm256_storeu_ps(entry_ + at, _mm256_permutevar8x32_ps(entries, order));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(link_ + at), _mm256_permutevar8x32_epi32(links, order));
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(count_ + at), _mm256_permutevar8x32_epi32(counts, order));
    }

    int size_;
    float entry_[kSize];
    uint32_t link_[kSize], count_[kSize];
};

} // namespace pertev

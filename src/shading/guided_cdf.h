#pragma once

// A cdf with a guide table: selects an index with a given probability, in constant expected time. The larger of two
// numbers never selects the smaller index, so evenly spread points select evenly spread indices, and the position
// within an index's numbers can be used again ("the rest").
//
// Source: the guide table is from Chen and Asau, "On Generating Random Variates from an Empirical Distribution", AIIE
// Transactions 6(2), 1974. A slot with many indices is searched by bisection, so that none is slow.
//
// The cdf consists of integers: index i owns the numbers [starts[i], starts[i + 1]) of 2^31. Each index is selected
// with exactly the stored probability, and every weight above 0 owns at least one number.

#include <cstdint>
#include <span>
#include <vector>

#include "base/host_device.h"
#include "math/random.h"
#include "math/sampler.h"
#include "math/scalar.h"

namespace pertev {

struct GuidedCdfView {
    const uint32_t* starts = nullptr; // [count + 1], from 0 to 2^31; null if there is nothing to select
    const uint32_t* guide =
        nullptr; // [2^guide_bits + 1] index that owns the first number of each slot; the last: of all
    uint32_t count = 0;
    uint32_t guide_bits = 0; // at most 30
};

struct CdfDraw {
    uint32_t index = 0;
    uint32_t owned = 0; // numbers that the index owns: its probability times 2^31
    uint32_t rest = 0;  // position of the number among them
    uint32_t more = 0;  // 32 bits, independent of the number: binary places of `rest` after the point
};

/// Probability of an index that owns so many numbers.
HD inline float cdf_pmf(uint32_t owned) { return static_cast<float>(owned) * 0x1p-31f; }
HD inline float cdf_pmf(const GuidedCdfView& table, uint32_t index) {
    return cdf_pmf(table.starts[index + 1] - table.starts[index]);
}

/// Selects an index by the first 31 bits of `number`; `more` are 32 bits that are uniform for each `number`.
HD inline CdfDraw draw_ordered(const GuidedCdfView& table, uint32_t number, uint32_t more) {
    number >>= 1;
    if (table.count == 1) return {0, 1u << 31, number, more};
    const uint32_t slot = number >> (31 - table.guide_bits);
    uint32_t index = table.guide[slot], last = table.guide[slot + 1];
    while (index < last) { // the last index that starts at or before the number
        const uint32_t middle = last - (last - index) / 2;
        if (table.starts[middle] <= number) {
            index = middle;
        } else {
            last = middle - 1;
        }
    }
    const uint32_t start = table.starts[index];
    return {index, table.starts[index + 1] - start, number - start, more};
}

/// Position of a number within those of its index, uniform in (0, 1); arguments as in CdfDraw.
template <class T>
HD inline T rest_of(T rest, T owned, WordOf<T> more) {
    return min((rest + unit_interval<T>(more)) / owned, T(0x1.fffffep-1f));
}
HD inline float rest_of(const CdfDraw& draw) {
    return rest_of(static_cast<float>(draw.rest), static_cast<float>(draw.owned), draw.more);
}

/// Position within the drawn interval as 32 bits, to select from another table. All 2^32 values have exactly the same
/// probability.
HD inline uint32_t number_of_rest(const CdfDraw& draw) {
    if (draw.owned == 1u << 31) return draw.rest << 1 | draw.more >> 31;
    return static_cast<uint32_t>((uint64_t(draw.rest) << 32 | draw.more) / draw.owned);
}

/// 32 bits that are uniform for each x, and for each y, for use as `more` of a table that one of them selects from:
/// for a fixed x a permutation of y, and vice versa.
HD inline uint32_t bits_behind(SampleBits u) { return hash_word(u.x + hash_word(u.y)); }

/// Number of bits of the guide table for `count` weights in [1, 2^30]: one slot per weight.
uint32_t guide_bits_for(std::size_t count);

/// Fills `starts` [weights + 1] and `guide` [2^guide_bits_for(weights) + 1] and returns the sum of the weights. A
/// weight that is not finite and positive counts as 0 and is never selected; any other owns at least one number.
/// Without any positive weight the sum and all starts are 0.
double build_guided_cdf(std::span<const double> weights, std::span<uint32_t> starts, std::span<uint32_t> guide);

/// A table that owns its memory; empty when all weights are 0.
struct GuidedCdf {
    std::vector<uint32_t> starts, guide;
};
GuidedCdf build_guided_cdf(std::span<const double> weights);

/// View of a table in host memory, valid as long as the table.
GuidedCdfView view_of(const GuidedCdf& table);

} // namespace pertev

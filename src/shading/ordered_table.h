#pragma once

// Draws an index with a given probability, in constant expected time, by inverting the cumulative distribution: of two
// numbers the larger never draws the smaller index. So points that are spread evenly draw indices that are, and what
// lies between two indices' first numbers can be drawn from again ("the rest").
//
// Source: the guide table is Chen and Asau's, "On Generating Random Variates from an Empirical Distribution", AIIE
// Transactions 6(2), 1974. A slot of it with many indices is searched by halving, so that none is slow.
//
// The table is one of whole numbers: index i owns the numbers [starts[i], starts[i + 1]) of 2^31. What is drawn has
// exactly the probability that is stored, and every weight above 0 is drawn by one number at least.

#include <cstdint>
#include <span>
#include <vector>

#include "base/host_device.h"
#include "math/random.h"
#include "math/sampler.h"
#include "math/scalar.h"

namespace pertev {

struct OrderedTableView {
    const uint32_t* starts = nullptr; // [count + 1], from 0 to 2^31; none: nothing to draw from
    const uint32_t* guide =
        nullptr; // [2^guide_bits + 1] index that owns the first number of each slot; the last: of all
    uint32_t count = 0;
    uint32_t guide_bits = 0; // at most 30
};

struct OrderedDraw {
    uint32_t index = 0;
    uint32_t owned = 0; // numbers of the index: its probability times 2^31
    uint32_t rest = 0;  // which of them was drawn
    uint32_t more = 0;  // 32 bits, independent of the number drawn: digits of `rest` behind the point
};

/// Probability of an index that owns so many numbers.
HD inline float ordered_pmf(uint32_t owned) { return static_cast<float>(owned) * 0x1p-31f; }
HD inline float ordered_pmf(const OrderedTableView& table, uint32_t index) {
    return ordered_pmf(table.starts[index + 1] - table.starts[index]);
}

/// Index drawn by the first 31 digits of `number`; `more` are 32 bits that are uniform for each `number`.
HD inline OrderedDraw draw_ordered(const OrderedTableView& table, uint32_t number, uint32_t more) {
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

/// Where the number lies within those of its index, uniform in (0, 1).
HD inline float rest_of(const OrderedDraw& draw) {
    const float number = static_cast<float>(draw.rest) + unit_interval(draw.more);
    return min(number / static_cast<float>(draw.owned), 0x1.fffffep-1f);
}

/// The same as 32 digits, each of the 2^32 numbers with exactly the same probability: another table can be drawn from.
HD inline uint32_t number_of_rest(const OrderedDraw& draw) {
    if (draw.owned == 1u << 31) return draw.rest << 1 | draw.more >> 31;
    return static_cast<uint32_t>((uint64_t(draw.rest) << 32 | draw.more) / draw.owned);
}

/// 32 bits that are uniform for each x, and for each y, as `more` of a table that one of them draws from: a permutation
/// of the one for each of the other.
HD inline uint32_t bits_behind(SampleBits u) { return hash_word(u.x + hash_word(u.y)); }

/// Bits of the guide table that suits `count` in [1, 2^30] weights: a slot a weight.
uint32_t guide_bits_for(std::size_t count);

/// Fills `starts` [weights + 1] and `guide` [2^guide_bits_for(weights) + 1] and returns the sum of the weights. A
/// weight that is not finite and positive counts as 0 and is never drawn; any other owns one number at least. Without
/// any weight the sum is 0 and all starts are 0.
double build_ordered_table(std::span<const double> weights, std::span<uint32_t> starts, std::span<uint32_t> guide);

/// A table of its own; empty when all weights are 0.
struct OrderedTable {
    std::vector<uint32_t> starts, guide;
};
OrderedTable build_ordered_table(std::span<const double> weights);

/// View of a table in host memory; valid as long as the table is.
OrderedTableView view_of(const OrderedTable& table);

} // namespace pertev

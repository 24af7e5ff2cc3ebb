#pragma once

// Draws an index with a given probability in constant time, however many there are.
//
// Source: Walker's alias method (Vose 1991); built in one sweep without work lists as in Huebschle-Schneider and
// Sanders, "Parallel Weighted Random Sampling", ACM TOMS 48(3), 2022, section 4.1.
//
// Random numbers have few bits: 23 of a float leave 11 for the threshold of one slot in 4096. A threshold between two
// of them would be drawn with another probability than it says, and one below the least never. So the table is one of
// whole numbers. The slots are a power of two, a number's upper bits name one, and thresholds are in the numbers that
// are left: what is drawn has exactly the probability that is stored, and every weight above 0 is drawn by one number
// at least.

#include <cstdint>
#include <span>
#include <vector>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct AliasEntry {
    uint32_t threshold = 0; // numbers of this slot below it draw its own index
    uint32_t alias = 0;     // index that owns the rest
    float pmf = 0;          // probability of this entry's own index
};

struct AliasTableView {
    const AliasEntry* entries = nullptr; // [2^slot_bits]; none: nothing to draw from
    uint32_t slot_bits = 0;              // 1 to 31
};

struct AliasSample {
    uint32_t index = 0;
    float pmf = 0;
    float u = 0; // the number drawn, made uniform in [0, 1) again
};

/// A random number in (0, 1) of the sampler (math/sampler.h) as the 32 bits that sample_alias takes.
HD inline uint32_t alias_number(float u) { return static_cast<uint32_t>(min(u, 0x1.fffffep-1f) * 0x1p32f); }

/// Index drawn by 32 random bits, or by alias_number of a float where the table was built for those.
HD inline AliasSample sample_alias(const AliasTableView& table, uint32_t number) {
    const uint32_t size = 1u << (32 - table.slot_bits);
    const uint32_t slot = number >> (32 - table.slot_bits), rest = number & (size - 1);
    const AliasEntry entry = table.entries[slot];
    const bool is_own = rest < entry.threshold;
    const uint32_t index = is_own ? slot : entry.alias;
    const uint32_t first = is_own ? 0 : entry.threshold, count = is_own ? entry.threshold : size - entry.threshold;
    const float u = static_cast<float>(rest - first) / static_cast<float>(count);
    return {index, is_own ? entry.pmf : table.entries[index].pmf, min(u, 0x1.fffffep-1f)};
}

/// Probability that sample_alias draws `index`. The very number that it returns there.
HD inline float alias_pmf(const AliasTableView& table, uint32_t index) { return table.entries[index].pmf; }

/// The different numbers that a table is drawn with: all of 32 bits, or those of floats.
enum class AliasNumbers { Bits32 = 32, Floats = 23 };

/// Slots of a table of `count` in [1, 2^30] weights, as a power of two.
uint32_t alias_slot_bits(std::size_t count);

/// Fills `entries` [2^alias_slot_bits(weights.size())] and returns the sum of the weights, which may be at most 2^30
/// and, for floats, 2^20. A weight that is not finite and positive counts as 0 and is never drawn; any other has one
/// of the numbers at least. Without any weight the sum is 0, the entries are as they were.
double build_alias_entries(std::span<const double> weights, AliasNumbers numbers, std::span<AliasEntry> entries);
double build_alias_entries(std::span<const float> weights, AliasNumbers numbers, std::span<AliasEntry> entries);

/// Table over `weights`, drawn by 32 bits; no entries when all weights are 0.
std::vector<AliasEntry> build_alias_table(std::span<const float> weights);

/// View of a table in host memory; valid as long as the table is.
AliasTableView view_of(const std::vector<AliasEntry>& table);

} // namespace pertev

#pragma once

// Draws an index with a given probability in constant time, however many there are.
//
// Source: Walker's alias method (Vose 1991); built in one sweep without work lists as in Huebschle-Schneider and
// Sanders, "Parallel Weighted Random Sampling", ACM TOMS 48(3), 2022, section 4.1.
// A float random number has about 24 bits: spread over 2^20 entries it would leave 4 for the threshold. So large
// tables have two levels, blocks and entries of a block, and take one number for each.

#include <cstdint>
#include <span>
#include <vector>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec2.h"

namespace pertev {

struct AliasEntry {
    float threshold = 1; // share of this slot that belongs to its own index
    uint32_t alias = 0;  // index that owns the rest
    float pmf = 0;       // probability of this entry's own index
};

struct AliasSample {
    uint32_t index = 0;
    float pmf = 0; // 0: nothing to draw from
    float u = 0;   // the number drawn, made uniform in [0, 1) again
};

/// Index drawn from `entries` [count], count in [1, 2^24], by `u` in [0, 1).
HD inline AliasSample sample_alias(const AliasEntry* entries, uint32_t count, float u) {
    constexpr float below_one = 0x1.fffffep-1f;
    const float scaled = u * static_cast<float>(count);
    const int slot = to_int(scaled, 0, static_cast<int>(count) - 1);
    const float rest = clamp(scaled - static_cast<float>(slot), 0.0f, below_one);
    const AliasEntry entry = entries[slot];
    if (rest < entry.threshold) {
        return {static_cast<uint32_t>(slot), entry.pmf, min(rest / entry.threshold, below_one)};
    }
    const float u_alias = (rest - entry.threshold) / (1.0f - entry.threshold);
    return {entry.alias, entries[entry.alias].pmf, min(u_alias, below_one)};
}

/// Two levels: `count` indices in blocks of `block_size` (the last may be shorter). With blocks of one there is only
/// the upper level, and the second random number is left as it was.
struct AliasTableView {
    const AliasEntry* blocks = nullptr;  // [ceil(count / block_size)]
    const AliasEntry* entries = nullptr; // [count], aliases and pmf within the block; none for blocks of one
    uint32_t count = 0;                  // 0: nothing to draw from
    uint32_t block_size = 1;
};

struct BlockAliasSample {
    uint32_t index = 0;
    float pmf = 0; // 0: nothing to draw from
    Vec2 u;        // both numbers, made uniform again: x was used for the block, y within it
};

HD inline BlockAliasSample sample_alias(const AliasTableView& table, Vec2 u) {
    if (table.count == 0) return {};
    const uint32_t size = table.block_size, block_count = (table.count - 1) / size + 1;
    const AliasSample block = sample_alias(table.blocks, block_count, u.x);
    if (size == 1) return {block.index, block.pmf, {block.u, u.y}};
    const uint32_t first = block.index * size;
    const AliasSample entry = sample_alias(table.entries + first, min(size, table.count - first), u.y);
    return {first + entry.index, block.pmf * entry.pmf, {block.u, entry.u}};
}

/// Probability that sample_alias draws `index` < count. The very number that it returns there.
HD inline float alias_pmf(const AliasTableView& table, uint32_t index) {
    const float block = table.blocks[index / table.block_size].pmf;
    return table.block_size == 1 ? block : block * table.entries[index].pmf;
}

struct AliasTable {
    std::vector<AliasEntry> blocks, entries;
    uint32_t count = 0, block_size = 1;
    double total = 0; // sum of the weights
};

/// Fills `entries` [weights.size()] and returns the sum of the weights. A weight that is not finite and positive
/// counts as 0 and is never drawn, nor is one so small that its probability is 0 as a float. Without any weight the
/// sum is 0 and so is every pmf. The same bits for any number of threads.
double build_alias_entries(std::span<const double> weights, std::span<AliasEntry> entries);
double build_alias_entries(std::span<const float> weights, std::span<AliasEntry> entries);

/// Table over `weights` (fewer than 2^32) in blocks of `block_size` >= 1; 0 picks one: single entries up to 4096
/// weights, else about the square root of their number. count is 0 when all weights are.
AliasTable build_alias_table(std::span<const float> weights, uint32_t block_size = 0);

/// View of a table in host memory; valid as long as the table is.
inline AliasTableView view_of(const AliasTable& table) {
    return {table.blocks.data(), table.entries.data(), table.count, table.block_size};
}

} // namespace pertev

#include "shading/alias_table.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

template <class Weight>
double usable(Weight weight) {
    constexpr double largest = 1e300; // so that a sum of 2^32 of them may not overflow in practice
    const double w = static_cast<double>(weight);
    return w > 0 && w <= largest ? w : 0.0;
}

template <class Weight>
double build(std::span<const Weight> weights, std::span<AliasEntry> entries) {
    PERTEV_CHECK(weights.size() == entries.size() && weights.size() <= 1u << 24);
    const auto count = static_cast<uint32_t>(weights.size());
    double total = 0;
    for (const Weight weight : weights) total += usable(weight);

    // Probability of an index in slots: 1 fills one slot. 0 where the pmf that a caller sees is 0.
    const double slots_per_weight = total > 0 ? count / total : 0.0;
    uint32_t heaviest = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const float pmf = total > 0 ? static_cast<float>(usable(weights[i]) / total) : 0.0f;
        entries[i] = {1.0f, i, pmf};
        if (entries[heaviest].pmf < pmf) heaviest = i;
    }
    if (!(total > 0)) return 0;
    const auto share = [&](uint32_t i) { return entries[i].pmf > 0 ? usable(weights[i]) * slots_per_weight : 0.0; };
    const auto next = [&](uint32_t from, bool heavy) {
        while (from < count && (share(from) > 1.0) != heavy) ++from;
        return from;
    };

    // Heavy index j gives what it has over one slot to light indices i, in order, and turns light itself then.
    uint32_t i = next(0, false), j = next(0, true);
    double left = j < count ? share(j) : 0.0; // what j still has to give
    while (j < count) {
        if (left > 1.0) {
            if (i == count) break; // rounding left a trace too much
            const double own = share(i);
            entries[i].threshold = static_cast<float>(own);
            entries[i].alias = j;
            left = (left + own) - 1.0;
            i = next(i + 1, false);
        } else {
            const uint32_t heir = next(j + 1, true);
            if (heir == count) break; // j keeps its whole slot: `left` is 1 but for rounding
            entries[j].threshold = static_cast<float>(left);
            entries[j].alias = heir;
            left = (left + share(heir)) - 1.0;
            j = heir;
        }
    }
    for (; i < count; i = next(i + 1, false)) { // rounding left a trace too little
        if (entries[i].pmf == 0) entries[i] = {0.0f, heaviest, 0.0f};
    }
    return total;
}

uint32_t default_block_size(std::size_t count) {
    uint32_t size = 1;
    if (count > 4096) {
        while (std::size_t(size) * size < count) size *= 2;
    }
    return size;
}

} // namespace

double build_alias_entries(std::span<const double> weights, std::span<AliasEntry> entries) {
    return build(weights, entries);
}

double build_alias_entries(std::span<const float> weights, std::span<AliasEntry> entries) {
    return build(weights, entries);
}

AliasTable build_alias_table(std::span<const float> weights, uint32_t block_size) {
    PERTEV_CHECK(weights.size() < std::size_t(1) << 32);
    AliasTable table;
    if (weights.empty()) return table;
    const std::size_t size = block_size == 0 ? default_block_size(weights.size()) : block_size;
    table.block_size = static_cast<uint32_t>(size);
    table.blocks.resize((weights.size() - 1) / size + 1);
    if (size == 1) {
        table.total = build_alias_entries(weights, table.blocks);
    } else {
        table.entries.resize(weights.size());
        std::vector<double> block_weights(table.blocks.size());
        parallel_for(table.blocks.size(), std::max<std::size_t>(1, 65536 / size), [&](uint64_t block) {
            const std::size_t first = block * size, n = std::min(size, weights.size() - first);
            block_weights[block] =
                build_alias_entries(weights.subspan(first, n), std::span(table.entries).subspan(first, n));
        });
        table.total = build_alias_entries(block_weights, table.blocks);
    }
    if (table.total > 0) table.count = static_cast<uint32_t>(weights.size());
    return table;
}

} // namespace pertev

#include "shading/alias_table.h"

#include <algorithm>
#include <bit>

#include "base/error.h"

namespace pertev {
namespace {

template <class Weight>
double usable(Weight weight) {
    constexpr double largest = 1e300; // so that a sum of 2^32 of them may not overflow in practice
    const double w = static_cast<double>(weight);
    return w > 0 && w <= largest ? w : 0.0;
}

/// How many of 2^bits numbers draw each index: one for every weight above 0, the others by weight, all in all 2^bits.
template <class Weight>
std::vector<uint64_t> share_numbers(std::span<const Weight> weights, double total, uint32_t bits) {
    const auto positive = static_cast<uint64_t>(
        std::count_if(weights.begin(), weights.end(), [](Weight weight) { return usable(weight) > 0; }));
    const double by_weight = static_cast<double>((uint64_t(1) << bits) - positive);
    std::vector<uint64_t> shares(weights.size());
    double sum = 0;
    uint64_t given = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const double weight = usable(weights[i]);
        if (!(weight > 0)) continue;
        sum += weight;
        const auto until_here = static_cast<uint64_t>(sum / total * by_weight); // all at the end: sum is total there
        shares[i] = 1 + until_here - given;
        given = until_here;
    }
    return shares;
}

template <class Weight>
double build(std::span<const Weight> weights, AliasNumbers numbers, std::span<AliasEntry> entries) {
    const auto bits = static_cast<uint32_t>(numbers);
    const uint32_t slot_bits = alias_slot_bits(weights.size());
    PERTEV_CHECK(entries.size() == std::size_t(1) << slot_bits && slot_bits + 2 <= bits);
    double total = 0;
    for (const Weight weight : weights) total += usable(weight);
    if (!(total > 0)) return 0;

    std::vector<uint64_t> shares = share_numbers(weights, total, bits);
    shares.resize(entries.size());
    const uint64_t slot = uint64_t(1) << (bits - slot_bits); // numbers of one slot
    const uint32_t unit = 1u << (32 - bits);                 // of thresholds, which are those of 32 bits
    const auto next = [&](std::size_t from, bool heavy) {
        while (from < shares.size() && (shares[from] > slot) != heavy) ++from;
        return from;
    };
    const auto fill = [&](std::size_t i, uint64_t own, std::size_t alias) {
        entries[i].threshold = static_cast<uint32_t>(own) * unit;
        entries[i].alias = static_cast<uint32_t>(alias);
    };
    for (std::size_t i = 0; i < shares.size(); ++i) {
        entries[i] = {static_cast<uint32_t>(slot) * unit, static_cast<uint32_t>(i),
                      static_cast<float>(std::ldexp(static_cast<double>(shares[i]), -static_cast<int>(bits)))};
    }

    // Heavy index j gives what it has over one slot to light indices i, in order, and turns light itself then. Whole
    // numbers: at the end the last one's slot is just full.
    std::size_t i = next(0, false), j = next(0, true);
    uint64_t left = j < shares.size() ? shares[j] : 0; // what j still has to give
    while (j < shares.size()) {
        if (left > slot) {
            fill(i, shares[i], j);
            left -= slot - shares[i];
            i = next(i + 1, false);
        } else {
            const std::size_t heir = next(j + 1, true);
            if (heir == shares.size()) break;
            fill(j, left, heir);
            left += shares[heir] - slot;
            j = heir;
        }
    }
    return total;
}

} // namespace

uint32_t alias_slot_bits(std::size_t count) {
    return std::max(1u, static_cast<uint32_t>(std::bit_width(std::max<std::size_t>(count, 1) - 1)));
}

double build_alias_entries(std::span<const double> weights, AliasNumbers numbers, std::span<AliasEntry> entries) {
    return build(weights, numbers, entries);
}

double build_alias_entries(std::span<const float> weights, AliasNumbers numbers, std::span<AliasEntry> entries) {
    return build(weights, numbers, entries);
}

std::vector<AliasEntry> build_alias_table(std::span<const float> weights) {
    std::vector<AliasEntry> table(std::size_t(1) << alias_slot_bits(weights.size()));
    if (!(build_alias_entries(weights, AliasNumbers::Bits32, table) > 0)) table.clear();
    return table;
}

AliasTableView view_of(const std::vector<AliasEntry>& table) {
    return table.empty() ? AliasTableView{} : AliasTableView{table.data(), alias_slot_bits(table.size())};
}

} // namespace pertev

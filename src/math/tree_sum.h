#pragma once

// Sums of many terms in a fixed binary tree, the halves of which are added once they are whole. Rounding is by about
// log2(count) units in the last place of the sum of magnitudes, where one term after the other is by as many as there
// are terms; and the tree depends on the count alone, so that the bytes of a sum do too.
//
// Source: Higham, "The Accuracy of Floating Point Summation", SIAM Journal on Scientific Computing 14(4), 1993
// (pairwise summation).
//
// The tree: the left half has as many terms as the largest power of two below the count, the right half the others. So
// terms [m 2^k, (m + 1) 2^k) are a tree of their own wherever all of them are there.

#include <bit>
#include <cstdint>
#include <type_traits>

namespace pertev {

/// Of `count` terms from `first` on, a power of two: the same tree without calls.
template <uint64_t count, class Term>
inline auto tree_sum_of_block(uint64_t first, Term& term) -> std::decay_t<decltype(term(first))> {
    if constexpr (count == 1) {
        return term(first);
    } else {
        const auto left = tree_sum_of_block<count / 2>(first, term);
        const auto right = tree_sum_of_block<count / 2>(first + count / 2, term);
        return left + right;
    }
}

/// Of `count` terms from `first` on, 1 at least.
template <class Term>
auto tree_sum_of(uint64_t first, uint64_t count, Term& term) -> std::decay_t<decltype(term(first))> {
    constexpr uint64_t block = 16;
    if (count == block) return tree_sum_of_block<block>(first, term);
    if (count == 1) return term(first);
    const uint64_t half = std::bit_floor(count - 1);
    const auto left = tree_sum_of(first, half, term);
    const auto right = tree_sum_of(first + half, count - half, term);
    return left + right;
}

/// term(0) + ... + term(count - 1), each asked for once and in this order; of none what its type's {} is. The type has
/// a + b.
template <class Term>
auto tree_sum(uint64_t count, Term&& term) -> std::decay_t<decltype(term(count))> {
    if (count == 0) return {};
    return tree_sum_of(0, count, term);
}

} // namespace pertev

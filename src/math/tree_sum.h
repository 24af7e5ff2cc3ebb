#pragma once

// Pairwise summation in a fixed binary tree. The rounding error is about log2(count) units in the last place of the
// sum of magnitudes, where sequential summation has as many as there are terms. The tree depends only on the count,
// so the bytes of a sum do too.
//
// Source: Higham, "The Accuracy of Floating Point Summation", SIAM Journal on Scientific Computing 14(4), 1993
// (pairwise summation).
//
// The left half of the tree has as many terms as the largest power of two below the count, the right half the others.
// So terms [m 2^k, (m + 1) 2^k) form a subtree wherever all of them exist.

#include <bit>
#include <cstdint>
#include <type_traits>

namespace pertev {

/// Sum of `count` terms from `first` on, where count is a power of two. The tree is that of tree_sum_of, without calls.
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

/// Sum of `count` terms from `first` on; count is at least 1.
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

/// Returns term(0) + ... + term(count - 1), where each term is evaluated once and in this order; a value-initialized
/// term if count is 0. The type of a term has a + b.
template <class Term>
auto tree_sum(uint64_t count, Term&& term) -> std::decay_t<decltype(term(count))> {
    if (count == 0) return {};
    return tree_sum_of(0, count, term);
}

} // namespace pertev

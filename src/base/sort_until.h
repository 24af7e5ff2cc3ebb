#pragma once

// Sorts until a sink ends it: pieces of some thousand values by std::sort, which are then merged in rounds. The sink is
// checked before each piece and each merge of two.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/sink.h"

namespace pertev {

/// Sorts `values`; `is_before` is a total order. Needs memory for a second array of them.
template <class T, class IsBefore = std::less<>>
void sort_until(std::span<T> values, Sink& sink, const IsBefore& is_before = {}) {
    constexpr std::size_t kPiece = 1 << 16;
    const std::size_t count = values.size();
    const auto piece = [count](std::span<T> all, std::size_t begin, std::size_t size) {
        const std::size_t first = std::min(begin, count);
        return all.subspan(first, std::min(size, count - first));
    };
    for (std::size_t begin = 0; begin < count; begin += kPiece) {
        sink.check();
        std::ranges::sort(piece(values, begin, kPiece), is_before);
    }
    if (count <= kPiece) return;
    std::vector<T> other(count);
    std::span<T> from = values, to = other;
    for (std::size_t size = kPiece; size < count; size *= 2) {
        for (std::size_t begin = 0; begin < count; begin += 2 * size) {
            sink.check();
            std::ranges::merge(piece(from, begin, size), piece(from, begin + size, size),
                               piece(to, begin, 2 * size).begin(), is_before);
        }
        std::swap(from, to);
    }
    if (from.data() != values.data()) std::ranges::copy(from, values.begin());
}

} // namespace pertev

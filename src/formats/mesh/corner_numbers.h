#pragma once

// Numbers the corners of faces: equal ones get the same number, which follows the order of first use (as KeyNumbers of
// base/key_numbers.h). Few different corners share a position, so those of a position are found by it: neighbours in a
// file are neighbours in memory, unlike in a hash table. What does not fit that is hashed.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/key_numbers.h"
#include "formats/mesh/vertex_key.h"

namespace pertev {

class CornerNumbers {
public:
    /// Makes an object for these corners, whose `position` is an index.
    explicit CornerNumbers(std::span<const VertexKey> corners) : most_(corners.size()) {
        if (corners.empty()) return;
        const auto [least, largest] = std::ranges::minmax_element(corners, {}, &VertexKey::position);
        const std::size_t range = std::size_t(largest->position) - least->position + 1;
        if (range > kMostPerCorner * corners.size()) return;
        low_ = least->position;
        first_.assign(range, kNone);
    }

    /// Returns the number of one of the corners.
    uint32_t number_of(const VertexKey& corner) {
        if (!first_.empty()) {
            uint32_t previous = kNone, number = first_[corner.position - low_];
            for (int tried = 0; tried < kMostTried; ++tried) {
                if (number == kNone) {
                    const uint32_t added = add(corner);
                    (previous == kNone ? first_[corner.position - low_] : next_[previous]) = added;
                    return added;
                }
                if (keys_[number] == corner) return number;
                previous = number, number = next_[number];
            }
        }
        if (!others_) others_.emplace(most_);
        const uint32_t other = others_->number_of(corner);
        if (other == others_numbers_.size()) others_numbers_.push_back(add(corner));
        return others_numbers_[other];
    }
    /// The corners in the order of their numbers.
    const std::vector<VertexKey>& keys() const { return keys_; }

private:
    static constexpr uint32_t kNone = 0xffffffffu;
    static constexpr std::size_t kMostPerCorner = 4; // positions in the range of those of the corners
    static constexpr int kMostTried = 8;             // corners of a position that are not hashed

    uint32_t add(const VertexKey& corner) {
        keys_.push_back(corner);
        next_.push_back(kNone);
        return static_cast<uint32_t>(keys_.size() - 1);
    }

    std::size_t most_;
    uint32_t low_ = 0;            // the least position
    std::vector<uint32_t> first_; // the first number of each position, from the least on; empty: all are hashed
    std::vector<uint32_t> next_;  // the next number of the same position
    std::vector<VertexKey> keys_;
    std::optional<KeyNumbers<VertexKey>> others_;
    std::vector<uint32_t> others_numbers_; // numbers of those
};

} // namespace pertev

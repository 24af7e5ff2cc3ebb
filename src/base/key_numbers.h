#pragma once

// A hash table that numbers keys: equal keys get the same number, and new keys get the next one, so that numbers follow
// the order of first use. Open addressing; time and memory follow the number of keys, whatever their values are.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace pertev {

/// `Key` is an array or a struct of 32-bit words; equal keys have equal words.
template <class Key>
class KeyNumbers {
    static_assert(std::has_unique_object_representations_v<Key> && sizeof(Key) % sizeof(uint32_t) == 0);

public:
    /// `most` bounds the number of different keys; it is less than 2^32 - 1.
    explicit KeyNumbers(std::size_t most) : slots_(std::bit_ceil(2 * most + 1), kFree) {}

    uint32_t number_of(const Key& key) {
        const std::size_t mask = slots_.size() - 1;
        for (std::size_t at = hash(key) & mask;; at = (at + 1) & mask) {
            if (slots_[at] == kFree) {
                slots_[at] = static_cast<uint32_t>(keys_.size());
                keys_.push_back(key);
                return slots_[at];
            }
            if (keys_[slots_[at]] == key) return slots_[at];
        }
    }
    /// The keys in the order of their numbers.
    const std::vector<Key>& keys() const { return keys_; }

private:
    static constexpr uint32_t kFree = 0xffffffffu;

    static std::size_t hash(const Key& key) {
        uint64_t bits = 0;
        for (const uint32_t word : std::bit_cast<std::array<uint32_t, sizeof(Key) / sizeof(uint32_t)>>(key)) {
            bits = (bits ^ word) * 0x9e3779b97f4a7c15u;
            bits ^= bits >> 32;
        }
        return static_cast<std::size_t>(bits ^ (bits >> 29));
    }

    std::vector<uint32_t> slots_;
    std::vector<Key> keys_;
};

} // namespace pertev

#include "integrators/photon_map/order_photons.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "tracer/hploc/sort_codes.h"

namespace pertev {
namespace {

constexpr int kDigitBits = 11;

/// Least digit first.
void sort_on_host(uint64_t* keys, uint32_t* order, uint64_t* sorted_keys, uint32_t* sorted_order, uint32_t count,
                  int bits) {
    uint64_t* from_keys = keys;
    uint32_t* from_order = order;
    uint64_t* to_keys = sorted_keys;
    uint32_t* to_order = sorted_order;
    std::vector<uint32_t> starts(1u << kDigitBits);
    for (int shift = 0; shift < bits; shift += kDigitBits) {
        const auto digit = [&](uint64_t key) { return static_cast<uint32_t>(key >> shift) & ((1u << kDigitBits) - 1); };
        std::ranges::fill(starts, 0);
        for (uint32_t i = 0; i < count; ++i) ++starts[digit(from_keys[i])];
        uint32_t sum = 0;
        for (uint32_t& start : starts) sum += std::exchange(start, sum);
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t at = starts[digit(from_keys[i])]++;
            to_keys[at] = from_keys[i];
            to_order[at] = from_order[i];
        }
        std::swap(from_keys, to_keys);
        std::swap(from_order, to_order);
    }
    if (from_keys == sorted_keys) return;
    std::copy_n(from_keys, count, sorted_keys);
    std::copy_n(from_order, count, sorted_order);
}

} // namespace

void sort_photons(Queue& queue, Buffer<std::byte>& scratch, uint64_t* keys, uint32_t* order, uint64_t* sorted_keys,
                  uint32_t* sorted_order, uint32_t count, int bits) {
    if (count == 0) return;
    if (queue.is_cuda()) return sort_codes(queue, scratch, keys, order, sorted_keys, sorted_order, count);
    sort_on_host(keys, order, sorted_keys, sorted_order, count, bits);
}

} // namespace pertev

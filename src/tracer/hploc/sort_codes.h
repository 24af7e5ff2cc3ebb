#pragma once

// Sorts Morton codes, each with the number of its triangle; equal codes stay in the order of numbers. On a GPU by the
// radix sort of NVIDIA's CUB, which is part of the CUDA toolkit.

#include <cstdint>

#include "device/buffer.h"

namespace pertev {

/// Returns the bytes of `scratch` for `count` codes. In a dry run it returns an estimate.
std::size_t sort_scratch_bytes(Queue& queue, uint32_t count);

/// Arrays of `count`, on the queue's device. What was in `codes` and `order`, where order[i] is i, lies sorted in
/// `sorted_codes` and `sorted_order` afterwards.
void sort_codes(Queue& queue, Buffer<std::byte>& scratch, const uint64_t* codes, const uint32_t* order,
                uint64_t* sorted_codes, uint32_t* sorted_order, uint32_t count);

} // namespace pertev

#pragma once

// Sorts pairs of Morton code and triangle index; equal codes keep the order of their indices. A GPU uses the radix
// sort of NVIDIA's CUB, which is part of the CUDA toolkit.

#include <cstdint>

#include "base/sink.h"
#include "device/buffer.h"

namespace pertev {

/// Returns the bytes of `scratch` for `count` codes; an estimate in a dry run.
std::size_t sort_scratch_bytes(Queue& queue, uint32_t count);

/// Sorts `codes` and `order`, where order[i] is i, into `sorted_codes` and `sorted_order`. All arrays have `count`
/// elements on the queue's device. On the CPU `sink` may end it.
void sort_codes(Queue& queue, Buffer<std::byte>& scratch, const uint64_t* codes, const uint32_t* order,
                uint64_t* sorted_codes, uint32_t* sorted_order, uint32_t count, Sink& sink = nobody());

} // namespace pertev

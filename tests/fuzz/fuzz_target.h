#pragma once

// A fuzz target (tests/fuzz/film_files.cpp, history_files.cpp), for programs that make its inputs.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pertev {

/// Returns a file from which inputs may be made; different numbers give different kinds.
std::vector<std::byte> fuzz_seed(uint32_t number);
/// Runs the target and sets whether the input was read as a file. Aborts at a fault.
void fuzz_input(std::span<const std::byte> input, bool& is_read);

} // namespace pertev

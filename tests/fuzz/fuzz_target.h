#pragma once

// The fuzz target of film files (tests/fuzz/film_files.cpp), for programs that make its inputs.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pertev {

/// Returns a film file from which inputs may be made; different numbers give different kinds of films.
std::vector<std::byte> fuzz_seed(uint32_t number);
/// Runs the target and sets whether the input was a film. Aborts at a fault.
void fuzz_film_file(std::span<const std::byte> input, bool& is_film);

} // namespace pertev

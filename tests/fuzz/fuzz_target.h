#pragma once

// Fuzz targets: a kind of file, inputs to begin with, and what is done with an input. A program has a list of them.
// mutate.cpp makes inputs where there is no libFuzzer; with it, libfuzzer.cpp passes its inputs on (tools/fuzz.sh).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pertev {

struct FuzzTarget {
    const char* name;
    uint32_t kinds; // seeds have these numbers below it
    /// Returns a file from which inputs may be made, of a kind below `kinds`.
    std::vector<std::byte> (*seed)(uint32_t kind);
    /// Reads the input. Returns whether it was read as a file. Aborts at a fault.
    bool (*read)(std::span<const std::byte> input);
};

/// Returns the targets of this program.
std::span<const FuzzTarget> fuzz_targets();

std::vector<std::byte> film_seed(uint32_t kind), history_seed(uint32_t kind), mitsuba_seed(uint32_t kind),
    pbrt_seed(uint32_t kind);
bool read_film_input(std::span<const std::byte> input);
bool read_history_input(std::span<const std::byte> input);
bool read_mitsuba_input(std::span<const std::byte> input);
bool read_pbrt_input(std::span<const std::byte> input);

} // namespace pertev

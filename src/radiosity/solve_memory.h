#pragma once

// What solving takes of the host's memory, at most, told before any of it is done: an upper bound of each part, and of
// the largest sum of those that are there at a time.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "radiosity/radiosity_settings.h"
#include "render/prepare_scene.h"

namespace pertev {

struct SolveMemory {
    struct Part {
        std::string name;
        std::size_t bytes;
    };
    uint64_t patches = 0;    // that send, at most
    uint64_t shown = 0;      // when they have been divided, at most
    std::vector<Part> parts; // that are there while most memory is taken
    std::size_t bytes = 0;   // all of them
    std::size_t by_rows =
        0; // in place of links: `bytes` by RadiositySolver::GaussSeidel; 0: no links, or too many rows
};

/// For solve_radiosity by `threads` threads. Throws as SolvedScene and check_patch_count.
SolveMemory predict_memory(const PreparedScene& prepared, const RadiositySettings& settings, int threads);

/// Throws Error(OutOfMemory), with the largest parts and what would make them less, where it is more than `limit`.
void check_memory(const SolveMemory& memory, const RadiositySettings& settings, std::size_t limit);

} // namespace pertev

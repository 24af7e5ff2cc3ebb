#pragma once

// Predicts the host memory of a solve in advance: an upper bound of each part, and of the largest sum of parts that
// coexist.

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
    uint64_t patches = 0;    // sending patches, at most
    uint64_t shown = 0;      // patches after they have been divided, at most
    std::vector<Part> parts; // parts that coexist when memory peaks
    std::size_t bytes = 0;   // sum of the parts
    std::size_t by_rows = 0; // instead of links: `bytes` of RadiositySolver::GaussSeidel; 0: no links, or too many rows
};

/// Predicts the memory of solve_radiosity with `threads` threads. Throws as SolvedScene and check_patch_count.
SolveMemory predict_memory(const PreparedScene& prepared, const RadiositySettings& settings, int threads);

/// Throws Error(OutOfMemory), with the largest parts and how to reduce them, if the memory exceeds `limit` bytes.
void check_memory(const SolveMemory& memory, const RadiositySettings& settings, std::size_t limit);

} // namespace pertev

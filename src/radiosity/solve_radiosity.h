#pragma once

// Solves a scene's radiosity, on the host by all threads: patches, a row of form factors for each, the linear system,
// then patches are divided where light changes over them, and each part gathers what the system's patches send.
//
// Source: Goral et al. 1984; patches that send and smaller ones that receive: Cohen, Greenberg, Immel, Brock, "An
// Efficient Radiosity Approach for Realistic Image Synthesis", IEEE CG&A 6(3), 1986.

#include <cstdint>
#include <string>

#include "radiosity/radiosity_settings.h"
#include "radiosity/radiosity_solution.h"
#include "radiosity/work_watch.h"
#include "render/prepare_scene.h"

namespace pertev {

struct SolveStats {
    uint64_t patches = 0, shown = 0; // that send; that are shown
    uint64_t factors = 0;            // not 0
    uint64_t steps = 0;              // SolvedSystem's
    double left = 0;                 // SolvedSystem's
    double without_direct = 0;       // share of the patches; 0 unless it was interrupted
    double factor_seconds = 0, solve_seconds = 0, divide_seconds = 0;
    std::size_t bytes = 0; // that the system took, of the host's memory
    bool was_interrupted = false;
    bool reached_limit = false; // ended by the most steps that a solver takes, with more left than the tolerance
    float link_error = 0;       // HierarchicalSolution's
};

struct SolvedRadiosity {
    RadiositySolution solution;
    SolveStats stats;
};

/// Metres: what is asked for, or kPatchOfScene of the scene's longest side.
float patch_size_of(const PreparedScene& prepared, const RadiositySettings& settings);

/// The same bytes for any number of threads. Where `progress` returns false before there are form factors
/// Error(Interrupted) is thrown; later the solution has what has been solved by then. Throws as SolvedScene,
/// make_patches and check_light_ends. `most_links`: of solve_hierarchically.
SolvedRadiosity solve_radiosity(const PreparedScene& prepared, const RadiositySettings& settings,
                                const SolveProgress& progress = {}, uint64_t most_links = kMostLinks);

/// Warns of a solution that is less than what was asked for, whole though it is.
void warn_of_limits(const SolveStats& stats, const RadiositySettings& settings, Messages& messages);

/// As a JSON object: what makes the bytes of the solution.
std::string json_of(const RadiositySettings& settings);

} // namespace pertev

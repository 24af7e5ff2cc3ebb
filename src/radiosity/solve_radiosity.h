#pragma once

// Solves a scene's radiosity on the host with all threads: patches, a row of form factors for each, the linear
// system; then patches are divided where light varies, and each part gathers the light of the system's patches.
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
    uint64_t patches = 0, shown = 0; // sending patches, and displayed ones
    uint64_t factors = 0;            // nonzero factors
    uint64_t steps = 0;              // see SolvedSystem
    double left = 0;                 // see SolvedSystem
    double without_direct = 0;       // share of the patches; 0 unless it was interrupted
    double factor_seconds = 0, solve_seconds = 0, divide_seconds = 0;
    std::size_t bytes = 0; // host memory of the system
    bool was_interrupted = false;
    bool reached_limit = false; // stopped by a solver's maximum number of steps, with more left than the tolerance
    float link_error = 0;       // see HierarchicalSolution
};

struct SolvedRadiosity {
    RadiositySolution solution;
    SolveStats stats;
};

/// Patch size in metres: the requested one, or kPatchOfScene of the scene's longest side.
float patch_size_of(const PreparedScene& prepared, const RadiositySettings& settings);

/// Solves a scene's diffuse light. The result has the same bytes for any number of threads. If `sink` stops it before
/// there are form factors, Error(Interrupted) is thrown; later the solution is as far as it got. Throws as SolvedScene,
/// make_patches and check_light_ends. `max_links` is for solve_hierarchically.
SolvedRadiosity solve_radiosity(const PreparedScene& prepared, const RadiositySettings& settings, Sink& sink = nobody(),
                                uint64_t max_links = kMaxLinks);

/// Warns of a complete solution that does not meet the request.
void warn_of_limits(const SolveStats& stats, const RadiositySettings& settings, Sink& sink);

/// Settings that determine the bytes of the solution, as a JSON object.
std::string json_of(const RadiositySettings& settings);

} // namespace pertev

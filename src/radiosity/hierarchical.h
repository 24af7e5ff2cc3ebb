#pragma once

// Hierarchical radiosity: a link states that the light of a source is uniform over a receiver, within a tolerance.
// Distant or dark parts are linked as a whole, as clusters of triangles, and near and bright ones by smaller parts:
// an oracle estimates the error of a link, and if that is too large its receiver or its source is divided, whichever
// is larger. So the number of links is about that of patches, not its square.
//
// Sources: Hanrahan, Salzman, Aupperle, "A Rapid Hierarchical Radiosity Algorithm", SIGGRAPH 1991; clusters: Smits,
// Arvo, Greenberg 1994 (radiosity/cluster_tree.h). Shadow rays find direct light, including that of emitters.

#include <cstdint>
#include <vector>

#include "radiosity/patches.h"
#include "radiosity/radiosity_settings.h"
#include "radiosity/solved_scene.h"
#include "radiosity/work_watch.h"

namespace pertev {

struct HierarchicalSolution {
    PatchTree tree;              // the final subdivision
    std::vector<Rgb> irradiance; // [patches] W/m2
    uint64_t links = 0, passes = 0;
    double left = 1;            // share of the light that the last pass changed; 1 if there was no pass
    double without_direct = 0;  // share of the patches without computed direct light
    std::size_t bytes = 0;      // memory of links, patches and clusters
    bool reached_limit = false; // stopped by the maximum number of passes
    float link_error = 0;       // the link error that was used: the requested one, or a multiple of it
};

/// Solves with links between patches and clusters. `coarse` has whole triangles. They are divided until no edge is
/// longer than `patch_size` (metres), but only where the oracle requests it. Once `watch` is over the solution ends in
/// its present state. If there would be more than `max_links`, everything restarts with twice the link error,
/// repeatedly if needed; the bytes equal those of requesting that error directly. Throws Error(OverLimit) if no error
/// up to kLargestLinkError has so few.
HierarchicalSolution solve_hierarchically(const SolvedScene& scene, PatchTree coarse, float patch_size,
                                          const RadiositySettings& settings, WorkWatch& watch,
                                          uint64_t max_links = kMaxLinks);

inline constexpr float kLargestLinkError = 1e6f;

/// Maximum memory in bytes, if all patches were as small as possible.
std::size_t max_hierarchical_bytes(uint64_t patches, uint64_t triangles);

} // namespace pertev

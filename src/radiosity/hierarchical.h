#pragma once

// Hierarchical radiosity: a link says that the light of a source is the same all over a receiver, as near as it needs
// to be. What is far away or dark is linked as a whole, cluster by cluster of triangles, what is near and bright part
// by part: an oracle asks what a link could be wrong by, and where that is too much its receiver or its source is
// divided, whichever is larger. So there are about as many links as patches, and not their square.
//
// Sources: Hanrahan, Salzman, Aupperle, "A Rapid Hierarchical Radiosity Algorithm", SIGGRAPH 1991; clusters: Smits,
// Arvo, Greenberg 1994 (radiosity/cluster_tree.h). Light by way of no surface, of lamps too, is found by shadow rays.

#include <cstdint>
#include <vector>

#include "radiosity/patches.h"
#include "radiosity/radiosity_settings.h"
#include "radiosity/solved_scene.h"
#include "radiosity/work_watch.h"

namespace pertev {

struct HierarchicalSolution {
    PatchTree tree;              // as it was divided
    std::vector<Rgb> irradiance; // [patches] W/m2
    uint64_t links = 0, passes = 0;
    double left = 1;            // share of the light that the last pass changed; 1: there was none
    double without_direct = 0;  // share of the patches that direct light was not found for
    std::size_t bytes = 0;      // of links and of what stands for patches and clusters
    bool reached_limit = false; // ended by the most passes there are
    float link_error = 0;       // that it was made by: what was asked for, or a multiple of it
};

/// `coarse`: whole triangles. They are divided until no edge is longer than `patch_size` (metres), but where the oracle
/// asks for it alone. Once `watch` is over the solution ends where it is. Where there would be more than `most_links`
/// all begins anew with twice the link error, as often as it takes: the bytes are those of that error asked for at
/// once. Throws Error(OverLimit) where no error up to kLargestLinkError has so few.
HierarchicalSolution solve_hierarchically(const SolvedScene& scene, PatchTree coarse, float patch_size,
                                          const RadiositySettings& settings, WorkWatch& watch,
                                          uint64_t most_links = kMostLinks);

inline constexpr float kLargestLinkError = 1e6f;

/// What it holds at most, were all patches as small as they may become.
std::size_t most_hierarchical_bytes(uint64_t patches, uint64_t triangles);

} // namespace pertev

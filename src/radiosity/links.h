#pragma once

// Links of hierarchical radiosity: light of a source that counts as uniform over a receiver. Either is a patch, a
// former patch that was divided, or a cluster of triangles.

#include <cstdint>

#include "radiosity/patch_tree.h"

namespace pertev {

/// A PatchCode, or a cluster's number with kIsCluster.
using NodeCode = uint32_t;
inline constexpr NodeCode kIsCluster = 0x40000000u;
constexpr bool is_cluster(NodeCode code) { return code < kIsPatch && (code & kIsCluster) != 0; }
constexpr uint32_t cluster_of(NodeCode code) { return code & ~kIsCluster; }

inline constexpr uint32_t kMaxRaysOfLink = 16;

struct Link {
    NodeCode receiver, source;
    /// The form factor from the receiver to the source if both are patches. Otherwise it is V / (pi distance^2), with V
    /// the visible share of the source, times the cosine at a receiving patch. If they overlap, it is the factor of the
    /// source's power.
    float factor = 0;
    uint16_t rays = 0; // rays traced for it; 0: unknown so far
    uint16_t seen = 0; // rays that reached the source

    /// Estimated visible share of the source (Laplace's rule of succession).
    float visible() const { return (static_cast<float>(seen) + 1) / (static_cast<float>(rays) + 2); }
};
static_assert(sizeof(Link) == 16);

} // namespace pertev

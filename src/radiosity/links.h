#pragma once

// Links of hierarchical radiosity: light of a source that is taken as even over a receiver. Either is a patch, what was
// a patch before it was divided, or a cluster of triangles.

#include <cstdint>

#include "radiosity/patch_tree.h"

namespace pertev {

/// A PatchCode, or a cluster's number with kIsCluster.
using NodeCode = uint32_t;
inline constexpr NodeCode kIsCluster = 0x40000000u;
constexpr bool is_cluster(NodeCode code) { return code < kIsPatch && (code & kIsCluster) != 0; }
constexpr uint32_t cluster_of(NodeCode code) { return code & ~kIsCluster; }

inline constexpr uint32_t kMostRaysOfLink = 16;

struct Link {
    NodeCode receiver, source;
    /// Of a patch as source and as receiver: the form factor from the receiver to it. Else, with V the share of the
    /// source that is seen, V / (pi distance^2), times the cosine at a patch that receives. Where they overlap: of the
    /// power of the source.
    float factor = 0;
    uint16_t rays = 0; // that it was found by; 0: it is not known yet
    uint16_t seen = 0; // of them

    /// How much of the source is likely to be seen (Laplace's rule of succession).
    float visible() const { return (static_cast<float>(seen) + 1) / (static_cast<float>(rays) + 2); }
};
static_assert(sizeof(Link) == 16);

} // namespace pertev

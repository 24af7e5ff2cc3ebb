#pragma once

// The laboratory's traversals of binary and compressed trees as launches, with every ray distribution, for tests that
// run them on either device.

#include <cstdint>
#include <vector>

#include "accel/bvh/compressed_bvh.h"
#include "device/queue.h"
#include "trace/intersect/ray.h"
#include "trace/scene_trees.h"
#include "trace/warps/lane_counter.h"

namespace pertev::test {

/// Device pointers. In an any-hit search a hit's instance is 0 or kNoHit, and the rest is that of a new Hit.
struct TraversalBatch {
    const Ray* rays;
    Hit* hits;
    uint32_t count;
    uint32_t* pool; // one counter, 0 at first
};

/// Trees over the same triangles.
struct TraversalTrees {
    BvhView binary;
    CompressedBvhView compressed;
};
struct TraversalScenes {
    SceneBvhView binary;
    SceneTrees<CompressedBvhView> compressed;
};

struct TraversalLaunch {
    const char* traversal;
    const char* distribution;
    bool rta, near_first, any;
    void (*run)(Queue&, const TraversalTrees&, const TraversalBatch&);        // one tree
    void (*run_scene)(Queue&, const TraversalScenes&, const TraversalBatch&); // null if scenes are not supported
};
/// Returns the launches of all traversals on a device; on a CPU only with one ray per thread.
std::vector<TraversalLaunch> traversal_launches(bool on_cuda);

/// Counts the lanes of closest-hit searches by while-while with all switches on.
using LaneLaunch = void (*)(Queue&, const BvhView&, const TraversalBatch&, LaneCounts*);
std::vector<LaneLaunch> lane_launches(bool on_cuda);

} // namespace pertev::test

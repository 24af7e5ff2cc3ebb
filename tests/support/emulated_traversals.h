#pragma once

// The laboratory's traversals whose lanes vote, as kernels on emulated warps with every distribution of rays. This
// header belongs to the host and names only types of the host.

#include <cstdint>
#include <string>
#include <vector>

namespace pertev {
struct BvhView;
struct CompressedBvhView;
struct Hit;
struct LaneCounts;
struct Ray;
struct WoopBvhView;
template <class Tree>
struct SceneTrees;
} // namespace pertev

namespace pertev::test {

/// A batch of rays. In an any-hit search a hit's instance is 0 or kNoHit and the rest is that of a new Hit.
struct EmulatedBatch {
    const Ray* rays;
    Hit* hits;
    uint32_t* stores; // [count + 1]: how often each hit was stored, and how often a hit without a ray
    uint32_t count;
    uint32_t* pool;  // 0 at first
    uint32_t blocks; // blocks of 128 threads; with one ray per thread as many as needed
    uint32_t seed;
    LaneCounts* lanes = nullptr; // for batches that count
};

/// Trees over the same triangles.
struct EmulatedTrees {
    const BvhView* binary;
    const CompressedBvhView* compressed;
    const WoopBvhView* woop;
};
struct EmulatedScenes {
    const SceneTrees<BvhView>* binary;
    const SceneTrees<CompressedBvhView>* compressed;
};

struct EmulatedTraversal {
    const char* traversal;
    const char* distribution;
    const char* tests; // "exact", "fast", "woop"
    bool rta, near_first, any;
    bool cut_outs = false; // AcceptSome of tests/support/check_traversal.h
    bool counts_lanes = false;
    // Either one is set. It returns an error, or an empty text.
    std::string (*run)(const EmulatedTrees&, const EmulatedBatch&) = nullptr;
    std::string (*run_scene)(const EmulatedScenes&, const EmulatedBatch&) = nullptr;
};
std::vector<EmulatedTraversal> emulated_traversals();

} // namespace pertev::test

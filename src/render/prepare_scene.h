#pragma once

// From a validated Scene to what a render needs on the host: where the origin of its world is (world_centre), which
// meshes are baked into that world, the trees over them (built, or loaded from the cache), the lights. The same for
// every device and every structure. The scene itself keeps its coordinates, and so do cameras.

#include <filesystem>
#include <optional>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "base/messages.h"
#include "device_scene/placed_scene.h"
#include "tracer/scene_structures.h"

namespace pertev {

struct PrepareOptions {
    BvhBuildSettings bvh;
    std::optional<std::filesystem::path> bvh_cache; // folder of the on-disk cache; none = always build
    std::optional<TracerChoice> tracers; // whose structures are built at once; none = the default's trees alone
    std::optional<BvhBuilder> builder;   // of the trees; none = that of `tracers`, else of default ones
    /// Where the cache holds a tree of a better TreeBuild than this one, take that.
    bool may_be_better = false;
    bool keep_coordinates = false;             // the world is the scene's: for rays that are given in its coordinates
    std::optional<Vec3> centre;                // of the moved world, in place of the scene's own (world_centre)
    std::shared_ptr<const MotionKeys> motions; // PreparedScene's
};

struct PreparedScene : PlacedScene {
    BinaryTrees trees;                           // moved world and local spaces, by structures->builder()
    TopLevelBvh top_level;                       // over the instances that are not baked
    std::shared_ptr<SceneStructures> structures; // of `trees` and of others, built when they are asked for
    uint64_t triangles = 0;                      // in all trees
    std::vector<PlacedBvh> placed;               // what top_level is built of
    double build_seconds = 0; // placement, trees (built or read from the cache), structures asked for at once
};

/// Of a scene that has a name: it outlives what is prepared.
PreparedScene prepare_scene(const Scene& scene, const PrepareOptions& options, Messages& messages);
PreparedScene prepare_scene(const Scene&& scene, const PrepareOptions& options, Messages& messages) = delete;

} // namespace pertev

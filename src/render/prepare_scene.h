#pragma once

// Converts a validated Scene to the host data that a render needs: the origin of its world (world_centre), the meshes
// that are baked into that world, their trees (built, or loaded from the cache) and the lights. It is the same for
// every device and structure. The scene and its cameras keep their coordinates.

#include <filesystem>
#include <optional>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/tlas.h"
#include "base/sink.h"
#include "device_scene/placed_scene.h"
#include "tracer/scene_structures.h"

namespace pertev {

struct PrepareOptions {
    BvhBuildSettings bvh;
    std::optional<std::filesystem::path> bvh_cache; // folder of the disk cache; without one trees are always built
    std::optional<TracerChoice> tracers; // tracers whose structures are built at once; without them only the default
                                         // trees are
    std::optional<BvhBuilder> builder;   // builder of the trees; by default that of `tracers` or of the default
                                         // tracers
    /// True to accept a cached tree of a better TreeBuild than the requested one.
    bool may_be_better = false;
    bool keep_coordinates = false;             // keeps the scene's coordinates, for rays that are given in them
    std::optional<Vec3> centre;                // origin of the translated world, in place of the scene's own
                                               // (world_centre)
    std::shared_ptr<const MotionKeys> motions; // becomes PreparedScene::motions
    std::vector<bool> apart;                   // becomes PreparedScene::apart
};

struct PreparedScene : PlacedScene {
    BinaryTrees trees;                           // in the translated world and in local spaces, by
                                                 // structures->builder()
    Tlas tlas;                                   // over the instances that are not baked
    std::shared_ptr<SceneStructures> structures; // structures from `trees`, and others, which are built at the first
                                                 // request
    uint64_t triangles = 0;                      // in all trees
    std::vector<PlacedBvh> placed;               // contents of tlas
    std::vector<bool> apart;                     // [instance] those that keep trees of their own, so that moving them
                                                 // rebuilds none; empty: none
    double build_seconds = 0; // seconds for placement, trees (built or read from the cache) and the requested
                              // structures
};

/// Prepares `scene`, which must outlive the result.
PreparedScene prepare_scene(const Scene& scene, const PrepareOptions& options, Sink& sink);
PreparedScene prepare_scene(const Scene&& scene, const PrepareOptions& options, Sink& sink) = delete;

} // namespace pertev

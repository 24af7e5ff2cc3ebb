#pragma once

// A scene as it comes to a device, but for the trees over it: where the origin of its world is, what is baked into that
// world, what gives light there and what moves.

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/bvh/top_level_bvh.h"
#include "scene/scene.h"
#include "shading/build_light_set.h"

namespace pertev {

struct PlacedScene {
    const Scene* scene = nullptr; // outlives this
    Vec3 centre;                  // origin of the moved world, in the scene's coordinates, metres
    std::vector<bool> is_baked;   // of each instance
    LightSetData lights;          // moved world
    /// Of meshes whose vertices move, by Scene::shapes; those that are not on the host are at rest in all of the above.
    /// For whoever has such meshes (session/moving_scene.h); empty: no vertex moves.
    std::vector<MeshPose> poses;
    std::vector<uint32_t> tree_of_mesh;        // MeshPlacement's
    std::shared_ptr<const MotionKeys> motions; // of instances while a shutter is open, moved world; null: none moves
};

} // namespace pertev

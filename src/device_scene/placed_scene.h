#pragma once

// A scene for upload to a device, without trees: the origin of its world, the baked instances, the lights and the
// motions.

#include <cstdint>
#include <memory>
#include <vector>

#include "accel/bvh/tlas.h"
#include "scene/scene.h"
#include "shading/build_light_set.h"

namespace pertev {

struct PlacedScene {
    const Scene* scene = nullptr; // outlives this
    Vec3 centre;                  // origin of the translated world, in the scene's coordinates, metres
    std::vector<bool> is_baked;   // [instance]
    LightSetData lights;          // in the translated world
    /// [Scene::shapes] poses of meshes with moving vertices; vertices that are not on the host are at rest in
    /// everything above. For owners of such meshes (session/moving_scene.h); empty if no vertex moves.
    std::vector<MeshPose> poses;
    std::vector<uint32_t> blas_of_mesh;        // see MeshPlacement
    std::shared_ptr<const MotionKeys> motions; // motions of instances while a shutter is open, in the translated
                                               // world; null if none moves
};

} // namespace pertev

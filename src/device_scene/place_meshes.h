#pragma once

// Which meshes are baked into world space and which keep a tree of their own: decided here, once, for every structure
// alike; and the triangles of both kinds, as builders take them. Also where the origin of that world is: a picture's is
// moved to the scene, since floats are fine only near 0.

#include <cstdint>
#include <span>
#include <vector>

#include "accel/bvh/bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "scene/scene.h"

namespace pertev {

inline constexpr uint32_t kBakedMesh = 0xffffffffu;

struct MeshPlacement {
    std::vector<bool> is_baked;         // of each instance
    std::vector<uint32_t> tree_of_mesh; // number of the mesh's own tree, or kBakedMesh where no instance needs one
    uint32_t mesh_tree_count = 0;
    uint64_t copies = 0, copied_triangles = 0; // baked although their mesh is used more than once
    Vec3 centre;                               // of the world that they are placed in, in the scene's coordinates
};

/// Where the origin of a picture's world lies, in the scene's coordinates (metres), at rest: the centre_of() the box
/// round all instances (scene/scene_origin.h). A reader has moved a file's scene there already, so it is 0 then.
Vec3 world_centre(const Scene& scene);

/// An instance is baked when its mesh is used once and it may not move (scene/animation.h), or, moving or not, when its
/// transform's condition number is over 2^12: a local space so skewed would cost the boxes of a top level more than the
/// triangles cost memory. What is hidden is not. Throws Error(OverLimit) that names the instance with which such copies
/// are out of all proportion to the scene's own triangles. `centre`: the origin of the world they are placed in.
MeshPlacement place_meshes(const Scene& scene, Vec3 centre = {0, 0, 0});

/// The triangles of all baked instances, in the moved world. Throws Error(OverLimit) for more than one tree can hold.
std::vector<BvhTriangle> baked_triangles(const Scene& scene, const MeshPlacement& placement);
/// The triangles of a mesh, in its own space.
std::vector<BvhTriangle> mesh_triangles(const Mesh& mesh);

/// A scene's triangles as builders take them.
struct SceneTriangles {
    std::vector<BvhTriangle> baked;
    std::vector<std::vector<BvhTriangle>> meshes; // of each mesh that keeps a tree of its own

    SceneTriangles() = default;
    SceneTriangles(const Scene& scene, const MeshPlacement& placement);
    uint64_t count() const;
    /// 0 the baked ones, then those of the meshes.
    const std::vector<BvhTriangle>& part(std::size_t number) const { return number == 0 ? baked : meshes[number - 1]; }
    std::size_t parts() const { return 1 + meshes.size(); }
};

/// What the top level is built from; `bounds` are of the mesh trees. `motions`: of the instances while a shutter is
/// open; null: none.
std::vector<PlacedBvh> placed_trees(const Scene& scene, const MeshPlacement& placement, std::span<const Bounds3> bounds,
                                    const std::shared_ptr<const MotionKeys>& motions = nullptr);

} // namespace pertev

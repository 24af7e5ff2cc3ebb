#pragma once

// Decides, once for every structure, which meshes are baked into world space and which get a BLAS, and makes the
// triangles of both kinds for builders. It also sets the origin of that world near the scene, because floats are
// precise only near 0.

#include <cstdint>
#include <span>
#include <vector>

#include "accel/bvh/bvh.h"
#include "accel/bvh/tlas.h"
#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

inline constexpr uint32_t kBakedMesh = 0xffffffffu;
inline constexpr uint64_t kMaxSmallCopies = 1u << 18; // triangles in all instances of shared meshes that are small

struct MeshPlacement {
    std::vector<bool> is_baked;         // [instance]
    std::vector<uint32_t> blas_of_mesh; // index of the mesh's BLAS, or kBakedMesh if no instance needs one
    uint32_t mesh_tree_count = 0;
    uint64_t copies = 0, copied_triangles = 0; // baked because of their transforms although their mesh is shared
    Vec3 centre;                               // origin of the world in which they are placed, in the scene's
                                               // coordinates
};

/// Origin of a picture's world at rest, in the scene's coordinates (metres): the centre_of() the box around all
/// instances (scene/scene_origin.h). It is 0 if a reader has already moved the scene of a file.
Vec3 world_centre(const Scene& scene);

/// Places the meshes. An instance that may not move (scene/animation.h, `apart`) is baked if its mesh is used once, or
/// is small in all its instances together (kMaxSmallCopies) and the scene lets it be: a ray takes longer to enter a
/// mesh's own space than to go on in a somewhat larger tree. Moving or not, it is baked if its transform's condition
/// number is over 2^12, because such a skewed local space would enlarge the boxes of a TLAS more than the triangles
/// cost memory. Hidden instances are not baked. Throws Error(OverLimit) that names the instance with which such copies
/// exceed a multiple of the scene's own triangles. `centre` is the origin of the world in which they are placed, and
/// `apart` says of each instance whether a caller may move it; empty: of none.
MeshPlacement place_meshes(const Scene& scene, Vec3 centre = {0, 0, 0}, const std::vector<bool>& apart = {});

// Triangles for builders, which `sink` may end.

/// Triangles of all baked instances, in the translated world. Throws Error(OverLimit) if one tree cannot hold them.
std::vector<BvhTriangle> baked_triangles(const Scene& scene, const MeshPlacement& placement, Sink& sink = nobody());
/// The triangles of a mesh, in its own space.
std::vector<BvhTriangle> mesh_triangles(const Mesh& mesh, Sink& sink = nobody());

/// A scene's triangles for builders.
struct SceneTriangles {
    std::vector<BvhTriangle> baked;
    std::vector<std::vector<BvhTriangle>> meshes; // [BLAS]

    SceneTriangles() = default;
    SceneTriangles(const Scene& scene, const MeshPlacement& placement, Sink& sink);
    uint64_t count() const;
    /// Triangles of a part: part 0 has the baked ones; the meshes follow.
    const std::vector<BvhTriangle>& part(std::size_t number) const { return number == 0 ? baked : meshes[number - 1]; }
    std::size_t parts() const { return 1 + meshes.size(); }
};

/// Contents of the TLAS. `bounds` are those of the BLASes; `motions` are those of instances while a shutter
/// is open, or null.
std::vector<PlacedBvh> placed_trees(const Scene& scene, const MeshPlacement& placement, std::span<const Bounds3> bounds,
                                    const std::shared_ptr<const MotionKeys>& motions = nullptr);

} // namespace pertev

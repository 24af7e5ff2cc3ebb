#pragma once

// Meshes whose vertices move, in a device's memory. What they are made of (rest vertices, morph targets, joints and
// weights of each vertex) is uploaded once. For a time only the joints' matrices and the targets' weights travel, and a
// stage (scene/deform_vertices.h) makes positions, normals and tangents of them: the bytes that the host would make.

#include <cstdint>
#include <vector>

#include "device/buffer.h"
#include "device_scene/deformed_mesh.h"
#include "device_scene/placed_scene.h"
#include "device_scene/scene_view.h"
#include "scene/deform_vertices.h"

namespace pertev {

class DeformingMeshes {
public:
    DeformingMeshes() = default;
    /// Those that `prepared` has poses of; they have no vertices until set_poses. `version`: that of whoever was there
    /// before, so that none comes again. Throws Error(OutOfMemory).
    DeformingMeshes(Queue& queue, const PlacedScene& prepared, uint64_t version);

    uint64_t version() const { return version_; } // the last of DeformedMesh's
    bool is_empty() const { return meshes_.empty(); }
    /// Points the scene's meshes, by their numbers, to the vertices here.
    void point(std::vector<MeshView>& meshes) const;
    /// `meshes`: the scene's, on the device, after point(). Uploads those of before().
    void set_meshes(const std::vector<MeshView>& meshes);

    /// Moves the vertices to where prepared.poses has them, of meshes whose pose is another; takes no memory.
    void set_poses(const PlacedScene& prepared);

    /// Positions as they are now are those of before(), until the next call.
    void keep_positions();
    const MeshView* before() const { return before_.data(); }

    /// Those whose vertices the host has not, and which have a tree of their own.
    std::vector<DeformedMesh> deformed(const PlacedScene& prepared, const std::vector<MeshView>& meshes) const;

private:
    struct Deforming {
        uint32_t mesh, vertices;
        std::size_t first_joint, first_weight; // in joints_ and weights_
        DeformVertices stage;                  // of the device's arrays
        MeshPose pose;                         // of the vertices there
        uint64_t version = 0;                  // 0: no vertices yet
    };

    Queue* queue_ = nullptr;
    uint64_t version_ = 0;
    std::vector<Deforming> meshes_; // [Scene::shapes]
    std::vector<Transform> joints_; // of all shapes, one after the other, as they are uploaded
    std::vector<float> weights_;
    Buffer<std::byte> rest_;
    Buffer<Vec3> positions_, normals_; // of positions_ the second half is of the frame before
    Buffer<Vec4> tangents_;
    Buffer<Transform> joints_there_;
    Buffer<float> weights_there_;
    Buffer<MeshView> before_;
};

} // namespace pertev

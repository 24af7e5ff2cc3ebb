#pragma once

// Meshes with moving vertices in device memory. Their inputs (rest vertices, morph targets, joints and weights of
// each vertex) are uploaded once. For a time only the joints' matrices and the targets' weights are uploaded, and a
// stage (scene/deform_vertices.h) computes positions, normals and tangents with the same bytes as the host.

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
    /// Makes the meshes for which `prepared` has poses; they have no vertices until set_poses. `version` is that of
    /// the predecessor, so that no version is used twice. Throws Error(OutOfMemory).
    DeformingMeshes(Queue& queue, const PlacedScene& prepared, uint64_t version);

    uint64_t version() const { return version_; } // the latest DeformedMesh::version
    bool is_empty() const { return meshes_.empty(); }
    /// Points the scene's meshes, by their indices, to the vertices of this object.
    void point(std::vector<MeshView>& meshes) const;
    /// Uploads the meshes of before(). `meshes` are the scene's, on the device, after point().
    void set_meshes(const std::vector<MeshView>& meshes);

    /// Moves the vertices of meshes with a changed pose to prepared.poses; allocates nothing.
    void set_poses(const PlacedScene& prepared);

    /// Keeps the present positions for before() until the next call.
    void keep_positions();
    const MeshView* before() const { return before_.data(); }

    /// Meshes whose vertices are not on the host and that have a BLAS.
    std::vector<DeformedMesh> deformed(const PlacedScene& prepared, const std::vector<MeshView>& meshes) const;

private:
    struct Deforming {
        uint32_t mesh, vertices;
        std::size_t first_joint, first_weight; // offsets in joints_ and weights_
        DeformVertices stage;                  // with device arrays
        MeshPose pose;                         // pose of the present vertices
        uint64_t version = 0;                  // 0: no vertices yet
    };

    Queue* queue_ = nullptr;
    uint64_t version_ = 0;
    std::vector<Deforming> meshes_; // [Scene::shapes]
    std::vector<Transform> joints_; // joints of all shapes, one after the other, as they are uploaded
    std::vector<float> weights_;
    Buffer<std::byte> rest_;
    Buffer<Vec3> positions_, normals_; // the second half of positions_ belongs to the previous frame
    Buffer<Vec4> tangents_;
    Buffer<Transform> joints_there_;
    Buffer<float> weights_there_;
    Buffer<MeshView> before_;
};

} // namespace pertev

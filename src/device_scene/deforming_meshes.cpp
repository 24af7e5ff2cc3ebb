#include "device_scene/deforming_meshes.h"

#include <algorithm>

#include "device/launch.h"
#include "device_scene/part_arrays.h"
#include "device_scene/place_meshes.h"
#include "scene/shape_mesh.h"

namespace pertev {
namespace {

/// Total sizes of the arrays of all shapes.
struct Counts {
    std::size_t positions = 0, normals = 0, tangents = 0, joints = 0, weights = 0;
};

Counts count(const PlacedScene& prepared) {
    Counts all;
    for (std::size_t i = 0; i < prepared.poses.size(); ++i) {
        const MeshShape& shape = prepared.scene->shapes[i];
        const Mesh& mesh = prepared.scene->meshes[shape.mesh];
        all.positions += mesh.positions.size();
        all.normals += mesh.normals.size();
        all.tangents += mesh.tangents.size();
        all.joints += prepared.poses[i].joints.size();
        all.weights += shape.targets.size();
    }
    return all;
}

/// Returns the arrays that stages read. `targets` outlives the list.
PartArrays list_rest(const PlacedScene& prepared, std::vector<DeformVertices>& stages,
                     std::vector<std::vector<MorphTargetView>>& targets) {
    PartArrays arrays;
    const Scene& scene = *prepared.scene;
    stages.assign(prepared.poses.size(), {});
    targets.resize(prepared.poses.size());
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const MeshShape& shape = scene.shapes[i];
        DeformVertices& stage = stages[i];
        arrays.add(shape.positions, stage.base_positions);
        arrays.add(shape.normals, stage.base_normals);
        arrays.add(shape.tangents, stage.base_tangents);
        arrays.add(shape.joints, stage.joints);
        arrays.add(shape.weights, stage.joint_weights);
        targets[i].resize(shape.targets.size());
        for (std::size_t k = 0; k < shape.targets.size(); ++k) {
            arrays.add(shape.targets[k].positions, targets[i][k].positions);
            arrays.add(shape.targets[k].normals, targets[i][k].normals);
            arrays.add(shape.targets[k].tangents, targets[i][k].tangents);
        }
        arrays.add(targets[i], stage.targets);
    }
    return arrays;
}

template <class T>
Buffer<T> make_buffer(Queue& queue, std::size_t count, const char* name) {
    return count > 0 ? Buffer<T>(queue, count, name) : Buffer<T>();
}

} // namespace

DeformingMeshes::DeformingMeshes(Queue& queue, const PlacedScene& prepared, uint64_t version)
    : queue_(&queue), version_(version) {
    if (prepared.poses.empty()) return;
    const Counts all = count(prepared);
    std::vector<DeformVertices> stages;
    std::vector<std::vector<MorphTargetView>> targets;
    list_rest(prepared, stages, targets).upload(queue, rest_, "meshes at rest");
    positions_ = make_buffer<Vec3>(queue, 2 * all.positions, "positions of deforming meshes");
    normals_ = make_buffer<Vec3>(queue, all.normals, "normals of deforming meshes");
    tangents_ = make_buffer<Vec4>(queue, all.tangents, "tangents of deforming meshes");
    joints_there_ = make_buffer<Transform>(queue, all.joints, "joints");
    weights_there_ = make_buffer<float>(queue, all.weights, "weights of morph targets");
    before_ = make_buffer<MeshView>(queue, prepared.scene->meshes.size(), "meshes before");
    joints_.resize(all.joints);
    weights_.resize(all.weights);
    Counts at;
    for (std::size_t i = 0; i < stages.size(); ++i) {
        const MeshShape& shape = prepared.scene->shapes[i];
        const Mesh& mesh = prepared.scene->meshes[shape.mesh];
        DeformVertices& stage = stages[i];
        stage.joints_per_vertex = prepared.poses[i].joints.empty() ? 0 : shape.joints_per_vertex;
        stage.target_count = static_cast<uint32_t>(shape.targets.size());
        stage.world_from_joints = joints_there_.data() + at.joints;
        stage.morph_weights = weights_there_.data() + at.weights;
        stage.positions = positions_.data() + at.positions;
        stage.normals = mesh.normals.empty() ? nullptr : normals_.data() + at.normals;
        stage.tangents = mesh.tangents.empty() ? nullptr : tangents_.data() + at.tangents;
        meshes_.push_back({.mesh = shape.mesh,
                           .vertices = static_cast<uint32_t>(mesh.positions.size()),
                           .first_joint = at.joints,
                           .first_weight = at.weights,
                           .stage = stage,
                           .pose = {}});
        at.positions += mesh.positions.size();
        at.normals += mesh.normals.size();
        at.tangents += mesh.tangents.size();
        at.joints += prepared.poses[i].joints.size();
        at.weights += shape.targets.size();
    }
}

void DeformingMeshes::point(std::vector<MeshView>& meshes) const {
    for (const Deforming& mesh : meshes_) {
        meshes[mesh.mesh].positions = mesh.stage.positions;
        meshes[mesh.mesh].normals = mesh.stage.normals;
        meshes[mesh.mesh].tangents = mesh.stage.tangents;
    }
}

void DeformingMeshes::set_meshes(const std::vector<MeshView>& meshes) {
    if (is_empty()) return;
    std::vector<MeshView> before = meshes;
    for (const Deforming& mesh : meshes_) before[mesh.mesh].positions += positions_.size() / 2;
    before_.upload(before);
}

void DeformingMeshes::set_poses(const PlacedScene& prepared) {
    bool any = false; // whether any vertices are computed here
    std::vector<bool> moves(meshes_.size());
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
        Deforming& mesh = meshes_[i];
        const MeshPose& pose = prepared.poses[i];
        if (mesh.version > 0 && same_pose(pose, mesh.pose)) continue;
        mesh.pose = pose;
        mesh.version = ++version_;
        if (pose.is_on_host) {
            const Mesh& made = prepared.scene->meshes[mesh.mesh];
            const auto upload = [&](auto* to, const auto& from) {
                if (!from.empty()) queue_->copy_to_device(to, from.data(), from.size() * sizeof(from[0]));
            };
            upload(mesh.stage.positions, made.positions);
            upload(mesh.stage.normals, made.normals);
            upload(mesh.stage.tangents, made.tangents);
            continue;
        }
        std::ranges::copy(pose.joints, joints_.begin() + static_cast<std::ptrdiff_t>(mesh.first_joint));
        const std::size_t weights = std::min<std::size_t>(pose.morph_weights.size(), mesh.stage.target_count);
        for (std::size_t k = 0; k < mesh.stage.target_count; ++k) {
            weights_[mesh.first_weight + k] = k < weights ? pose.morph_weights[k] : 0.0f;
        }
        moves[i] = any = true;
    }
    if (!any) return;
    joints_there_.upload(joints_);
    weights_there_.upload(weights_);
    for (std::size_t i = 0; i < meshes_.size(); ++i) {
        if (moves[i]) launch(*queue_, "deform vertices", meshes_[i].vertices, meshes_[i].stage);
    }
}

void DeformingMeshes::keep_positions() {
    if (is_empty()) return;
    const std::size_t count = positions_.size() / 2;
    queue_->copy_on_device(positions_.data() + count, positions_.data(), count * sizeof(Vec3));
}

std::vector<DeformedMesh> DeformingMeshes::deformed(const PlacedScene& prepared,
                                                    const std::vector<MeshView>& meshes) const {
    std::vector<DeformedMesh> deformed;
    for (const Deforming& mesh : meshes_) {
        const uint32_t tree = prepared.blas_of_mesh[mesh.mesh];
        if (mesh.pose.is_on_host || tree == kBakedMesh) continue;
        deformed.push_back({mesh.mesh, tree, mesh.version, prepared.scene->meshes[mesh.mesh].triangle_count(),
                            meshes[mesh.mesh].positions, meshes[mesh.mesh].indices});
    }
    return deformed;
}

} // namespace pertev

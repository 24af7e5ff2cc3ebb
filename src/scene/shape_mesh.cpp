#include "scene/shape_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <utility>

#include "base/parallel_for.h"
#include "scene/deform_vertices.h"

namespace pertev {
namespace {

constexpr uint64_t kVerticesAtOnce = 1 << 12;

template <class T>
const T* data_or_null(const std::vector<T>& values) {
    return values.empty() ? nullptr : values.data();
}

bool turns_over(const DeformVertices& stage, uint64_t vertices, std::span<const Transform> joints) {
    const auto mirrors = [](const Transform& m) { return determinant(m) < 0; };
    if (std::ranges::none_of(joints, mirrors)) return false;
    std::atomic<int64_t> balance{0}; // inverted vertices minus those that are not
    parallel_for_ranges(vertices, kVerticesAtOnce, [&](uint64_t begin, uint64_t end) {
        int64_t sum = 0;
        for (uint64_t i = begin; i < end; ++i) {
            Transform m;
            if (stage.blend(static_cast<uint32_t>(i), m)) sum += mirrors(m) ? 1 : -1;
        }
        balance += sum;
    });
    return balance > 0;
}

} // namespace

bool same_pose(const MeshPose& a, const MeshPose& b) {
    // Zeros of different sign count as different, because results computed from them may differ.
    const auto same_bits = [](const auto& one, const auto& other) {
        return one.size() == other.size() &&
               (one.empty() || std::memcmp(one.data(), other.data(), std::as_bytes(std::span(one)).size()) == 0);
    };
    return a.is_on_host == b.is_on_host && same_bits(a.morph_weights, b.morph_weights) && same_bits(a.joints, b.joints);
}

std::vector<Transform> joint_transforms(const Skin& skin, std::span<const Transform> world_from_node) {
    std::vector<Transform> joints;
    joints.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        const Transform& node = world_from_node[skin.joints[i]];
        joints.push_back(skin.joint_from_mesh.empty() ? node : compose(node, skin.joint_from_mesh[i]));
    }
    return joints;
}

bool shape_mesh(MeshShape& shape, std::span<const float> morph_weights, std::span<const Transform> joints, Mesh& mesh) {
    std::vector<MorphTargetView> targets;
    for (const MorphTarget& target : shape.targets) {
        targets.push_back(
            {data_or_null(target.positions), data_or_null(target.normals), data_or_null(target.tangents)});
    }
    const DeformVertices stage = {
        .base_positions = data_or_null(shape.positions),
        .base_normals = data_or_null(shape.normals),
        .base_tangents = data_or_null(shape.tangents),
        .targets = targets.data(),
        .morph_weights = morph_weights.data(),
        .target_count = static_cast<uint32_t>(std::min(targets.size(), morph_weights.size())),
        .joints_per_vertex = joints.empty() ? 0 : shape.joints_per_vertex,
        .joints = shape.joints.data(),
        .joint_weights = shape.weights.data(),
        .world_from_joints = joints.data(),
        .positions = mesh.positions.data(),
        .normals = mesh.normals.empty() ? nullptr : mesh.normals.data(),
        .tangents = mesh.tangents.empty() ? nullptr : mesh.tangents.data(),
    };
    const uint64_t vertices = mesh.positions.size();
    parallel_for(vertices, kVerticesAtOnce, [&](uint64_t i) { stage(static_cast<uint32_t>(i)); });
    const bool is_turned_over = turns_over(stage, vertices, joints);
    if (is_turned_over == shape.is_turned_over) return false;
    shape.is_turned_over = is_turned_over;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    return true;
}

void shape_at_rest(Scene& scene, std::span<MeshShape* const> shapes) {
    if (shapes.empty()) return;
    const std::vector<Transform> world_from_node =
        world_from_nodes(transforms_of(scene.nodes, parents_first(scene.nodes)), scene.origin_in_file);
    for (MeshShape* shape : shapes) {
        std::vector<Transform> joints;
        if (shape->skin != kNoSkin) joints = joint_transforms(scene.skins[shape->skin], world_from_node);
        const std::span<const float> weights =
            shape->node == kNoNode ? std::span<const float>() : scene.nodes[shape->node].morph_weights;
        shape_mesh(*shape, weights, joints, scene.meshes[shape->mesh]);
    }
}

} // namespace pertev

#include "shading/light_tree/build_light_tree.h"

#include <algorithm>
#include <utility>

#include "base/parallel_for.h"

namespace pertev {
namespace {

/// Returns what the tree holds for an instance of a subtree with this cone.
TreeLight light_of(const SharedTreeInstance& instance, const NormalCone& cone) {
    TreeLight light;
    light.bounds = instance.bounds;
    light.axis = normalize(transform_vector(instance.world_from_local, cone.axis));
    light.spread = cone.normals;
    light.emission_angle = cone.emission;
    light.has_two_sides = cone.has_two_sides;
    light.power = instance.power;
    return light;
}

LightTreeInstance instance_of(const SharedTreeInstance& from, uint32_t root, uint32_t first_leaf) {
    const Transform local_from_world = inverse(from.world_from_local);
    LightTreeInstance instance;
    instance.local_x = local_from_world.row0;
    instance.local_y = local_from_world.row1;
    instance.local_z = local_from_world.row2;
    instance.origin = from.world_from_local.translation;
    instance.scale = length(column(from.world_from_local, 0));
    instance.leaf = 0;
    instance.root = root;
    instance.first_light = from.first_light;
    instance.first_leaf = first_leaf;
    return instance;
}

/// The numbers of leaves: of lights without a subtree, of each subtree, and of all lights.
struct LeafCounts {
    uint32_t single = 0, all = 0;
    std::vector<uint32_t> of_subtrees;

    explicit LeafCounts(const TreeLights& lights) : single(count_leaves(lights.lights)), all(single) {
        for (const std::vector<TreeLight>& shared : lights.shared) of_subtrees.push_back(count_leaves(shared));
        for (const SharedTreeInstance& instance : lights.instances) {
            if (has_leaf(instance.power)) all += of_subtrees[instance.subtree];
        }
    }
};

} // namespace

uint32_t TreeLights::count() const { return LeafCounts(*this).all; }

bool is_similarity(const Transform& transform) {
    const Vec3 x = column(transform, 0), y = column(transform, 1), z = column(transform, 2);
    const float squared = length_squared(x), tolerance = 1e-4f * squared;
    const auto is_small = [&](float difference) { return abs(difference) <= tolerance; };
    return is_finite(transform) && squared > 0 && is_small(length_squared(y) - squared) &&
           is_small(length_squared(z) - squared) && is_small(dot(x, y)) && is_small(dot(x, z)) && is_small(dot(y, z));
}

LightTreeData build_light_tree(TreeLights from) {
    LightTreeData data;
    const auto light_count = static_cast<uint32_t>(from.lights.size());
    const LeafCounts counts(from);
    data.light_count = counts.all;
    data.leaf_of_light.assign(from.lights.size() + from.instances.size(), 0);
    if (data.light_count == 0) return data;

    std::vector<uint32_t> first_nodes, first_leaves; // shared subtrees come after the tree
    const auto placed = std::ranges::count_if(from.instances, has_leaf, &SharedTreeInstance::power);
    uint32_t nodes = 2 * (counts.single + static_cast<uint32_t>(placed)), leaves = 0;
    for (std::size_t i = 0; i < from.shared.size(); ++i) {
        first_nodes.push_back(std::exchange(nodes, nodes + 2 * counts.of_subtrees[i]));
        first_leaves.push_back(std::exchange(leaves, leaves + static_cast<uint32_t>(from.shared[i].size())));
    }
    data.nodes.resize(nodes);
    data.leaf_of_triangle.assign(leaves, 0);
    std::vector<NormalCone> cones(from.shared.size());
    parallel_for(cones.size(), 1, [&](uint64_t i) {
        const std::vector<TreeLight>& lights = from.shared[i];
        cones[i] =
            build_subtree(lights, {data.nodes.data(), first_nodes[i], data.leaf_of_triangle.data() + first_leaves[i],
                                   static_cast<uint32_t>(lights.size())});
    });
    for (const SharedTreeInstance& instance : from.instances) {
        from.lights.push_back(light_of(instance, cones[instance.subtree]));
        data.instances.push_back(
            instance_of(instance, first_nodes[instance.subtree] + kLightTreeRoot, first_leaves[instance.subtree]));
    }
    build_subtree(from.lights, {data.nodes.data(), 0, data.leaf_of_light.data(), light_count});

    for (uint32_t i = 0; i < data.instances.size(); ++i) {
        LightTreeInstance& instance = data.instances[i];
        instance.leaf = data.leaf_of_light[light_count + i];
        if (instance.leaf == 0) continue;
        const std::size_t triangles = from.shared[from.instances[i].subtree].size();
        const uint32_t* const leaf = data.leaf_of_triangle.data() + instance.first_leaf;
        for (std::size_t k = 0; k < triangles; ++k) {
            if (leaf[k] != 0) data.leaf_of_light[instance.first_light + k] = LightTreeNode::kLeaf | i;
        }
    }
    data.leaf_of_light.resize(light_count);
    return data;
}

RequestedLightTree::RequestedLightTree(TreeLights lights) : lights_(std::move(lights)), light_count_(lights_.count()) {}

const LightTreeData& RequestedLightTree::get() const {
    std::call_once(once_, [&] {
        data_ = build_light_tree(std::exchange(lights_, {}));
        is_built_ = true;
    });
    return data_;
}

} // namespace pertev

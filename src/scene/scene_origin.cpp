#include "scene/scene_origin.h"

#include <algorithm>
#include <cmath>

#include "base/limits.h"
#include "scene/position_bounds.h"
#include "scene/shape_mesh.h"

namespace pertev {
namespace {

double largest(DoubleVec3 v) { return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z))); }

double longest_side(const DoubleBounds3& box) { return largest(box.hi - box.lo); }

DoubleBounds3 box_in_file(const Scene& scene) {
    const Bounds3 near = bounds_of(scene);
    DoubleBounds3 box;
    if (near.is_empty()) return box;
    box.extend(in_file(scene, near.lo));
    box.extend(in_file(scene, near.hi));
    return box;
}

/// Places everything that belongs to nodes, relative to the scene's origin.
void update_world_transforms(Scene& scene) {
    const std::vector<NodeTransform> transforms = transforms_of(scene.nodes, parents_first(scene.nodes));
    const std::vector<Transform> world_from_node = world_from_nodes(transforms, scene.origin_in_file);
    for (Instance& instance : scene.instances) {
        if (instance.node == kNoNode || scene.nodes[instance.node].skin != kNoSkin) continue;
        instance.world_from_local =
            placed_in(transforms[instance.node], instance.node_from_local, scene.origin_in_file);
    }
    for (Camera& camera : scene.cameras)
        camera.world_from_camera.translation = rounded_to_file(scene, world_from_node[camera.node].translation);
    for (Light& light : scene.lights) light.position = world_from_node[light.node].translation;
    for (MeshShape& shape : scene.shapes) {
        if (shape.skin == kNoSkin) continue;
        const std::vector<Transform> joints = joint_transforms(scene.skins[shape.skin], world_from_node);
        shape_mesh(shape, scene.nodes[shape.node].morph_weights, joints, scene.meshes[shape.mesh]);
    }
}

/// Bounds of a sample of the scene's vertices. Its meshes have not passed validate(), so their indices may be out of
/// range.
Bounds3 sample_of(const Scene& scene) {
    Bounds3 sample;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        if (instance.is_hidden || mesh.indices.empty()) continue;
        for (const std::size_t i : {std::size_t(0), mesh.indices.size() / 2, mesh.indices.size() - 1}) {
            if (mesh.indices[i] >= mesh.positions.size()) continue;
            sample.extend(transform_point(instance.world_from_local, mesh.positions[mesh.indices[i]]));
        }
    }
    return sample;
}

} // namespace

DoubleVec3 centre_of(const DoubleBounds3& box) {
    if (box.is_empty()) return {0, 0, 0};
    int exponent = 0; // side = fraction in [1/2, 1) times 2^exponent
    const double fraction = std::frexp(longest_side(box), &exponent);
    const double grid = std::ldexp(1.0, fraction == 0.5 ? exponent - 1 : exponent);
    // Halves are rounded away from zero; adding 0 makes a zero positive.
    const auto rounded = [&](double a, double b) { return grid * std::round(0.5 * (a + b) / grid) + 0.0; };
    return {rounded(box.lo.x, box.hi.x), rounded(box.lo.y, box.hi.y), rounded(box.lo.z, box.hi.z)};
}

DoubleVec3 origin_for(const DoubleBounds3& box) {
    constexpr double kMovedSizes = 64;
    const DoubleVec3 centre = centre_of(box);
    const double away = largest(centre);
    const bool is_moved = away > kMovedSizes * longest_side(box) && away <= static_cast<double>(kMaxCoordinate);
    return is_moved ? centre : DoubleVec3{0, 0, 0};
}

void set_origin(const DoubleBounds3& box, Scene& scene) {
    scene.origin_in_file = origin_for(box);
    scene.is_far = largest(scene.origin_in_file) > kFarSizes * longest_side(box);
}

void subtract_centre(Scene& scene) {
    for (Instance& instance : scene.instances) {
        if (is_singular(instance.world_from_local)) instance.is_hidden = true;
    }
    if (surely_stays(sample_of(scene))) return;
    // Far away the first box has rounded positions; the second one is exact.
    for (int step = 0; step < 2; ++step) {
        const DoubleVec3 before = scene.origin_in_file;
        set_origin(box_in_file(scene), scene);
        if (scene.origin_in_file == before) return;
        update_world_transforms(scene);
    }
}

} // namespace pertev

#include "shading/list_tree_lights.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel_for.h"
#include "math/double_pi.h"
#include "math/portable_math.h"

namespace pertev {
namespace {

/// Returns the half angle, in radians, of the cone in which a light of a tree emits.
float emission_angle(const PunctualLight& light) {
    switch (light.kind) {
    case LightKind::Point:
        return kPi;
    case LightKind::Spot:
    case LightKind::Goniometric:
    case LightKind::Directional: // is in no tree
        break;
    }
    return acos(clamp(light.cos_outer, -1.0f, 1.0f));
}

/// Returns the power of a light of a tree: pi times its mean intensity in the cone. `power` is its own, W.
double power_in_tree(const PunctualLight& light, double power) {
    switch (light.kind) {
    case LightKind::Goniometric:
        return 0.5 * power / static_cast<double>(1 - light.cos_outer);
    case LightKind::Point:
    case LightKind::Spot:
    case LightKind::Directional: // is in no tree
        break;
    }
    return power > 0 ? kPiDouble * mean_of_channels(light.intensity) : 0;
}

/// Returns the triangle of an emitter for a tree, without power if its normal is lost. A spot's flux says little about
/// the light in its cone, nor does that of a second face about the light of the first.
TreeLight tree_light(Vec3 a, Vec3 ab, Vec3 ac, const EmissiveTriangle& triangle, double power) {
    TreeLight light;
    const Vec3 normal = cross(ab, ac);
    const float squared = length_squared(normal);
    if (!(squared > 0) || !is_finite(squared)) return light;
    for (const Vec3 edge : {Vec3{}, ab, ac}) light.bounds.extend(a + edge);
    light.axis = normalize(normal);
    light.emission_angle = 0.5f * kPi;
    light.has_two_sides = triangle.is_two_sided != 0;
    light.power = light.has_two_sides ? 0.5 * power : power;
    return light;
}

/// The fewest triangles of a mesh whose instances share a subtree: for a smaller one, the step into the mesh's space
/// costs more than its nodes.
constexpr uint64_t kFewestShared = 64;

/// Lists lights of a scene for its tree.
class TreeLightLister {
public:
    TreeLightLister(const Scene& scene, Vec3 centre, const LightSetData& data, std::span<const double> of_triangles)
        : scene_(scene), centre_(centre), data_(data), of_triangles_(of_triangles) {}

    TreeLights list(std::span<const double> of_punctual) {
        // The builder appends one light for each shared instance.
        to_.lights.reserve(data_.triangles.size() + of_punctual.size() + scene_.instances.size());
        list_triangles();
        share_subtrees();
        for (std::size_t i = 0; i < of_punctual.size(); ++i) {
            const PunctualLight& punctual = data_.punctual[i];
            TreeLight& light = to_.lights.emplace_back();
            light.bounds.extend(punctual.position);
            light.axis = punctual.direction;
            light.emission_angle = emission_angle(punctual);
            light.power = power_in_tree(punctual, of_punctual[i]);
        }
        return std::move(to_);
    }

private:
    void list_triangles() {
        to_.lights.resize(data_.triangles.size());
        parallel_for(data_.triangles.size(), 4096, [&](uint64_t i) {
            const EmissiveTriangle& triangle = data_.triangles[i];
            TreeLight& light = to_.lights[i];
            light = tree_light(triangle.a, triangle.ab, triangle.ac, triangle, of_triangles_[i]);
            if (triangle.is_mirrored != 0) light.axis = -light.axis;
        });
    }

    std::span<TreeLight> lights_of(uint32_t instance) {
        const uint64_t triangles = scene_.meshes[scene_.instances[instance].mesh].triangle_count();
        return std::span(to_.lights).subspan(data_.first_light[instance], triangles);
    }

    void share_subtrees() {
        std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>> alike; // instances by mesh and material
        for (uint32_t i = 0; i < scene_.instances.size(); ++i) {
            const Instance& instance = scene_.instances[i];
            if (data_.first_light[i] == kNoLight) continue;
            if (scene_.meshes[instance.mesh].triangle_count() < kFewestShared) continue;
            if (is_similarity(instance.world_from_local)) alike[{instance.mesh, instance.material}].push_back(i);
        }
        for (auto& [used, instances] : alike) {
            if (instances.size() > 1) share_subtree(scene_.meshes[used.first], std::move(instances));
        }
    }

    /// Returns whether the subtree's lights are those of the instance. A triangle whose area comes from rounding does
    /// not count.
    static bool has_lights_of(std::span<const TreeLight> subtree, std::span<const TreeLight> own) {
        for (std::size_t i = 0; i < own.size(); ++i) {
            const bool is_rounded = subtree[i].bounds.is_empty();
            if (has_leaf(subtree[i].power) != (has_leaf(own[i].power) && !is_rounded)) return false;
        }
        return true;
    }

    /// Takes the lights of instances together. The largest one gives the powers, which may underflow in a smaller one;
    /// an instance that has other lights than the subtree keeps its own.
    void share_subtree(const Mesh& mesh, std::vector<uint32_t> instances) {
        const uint32_t largest = std::ranges::max(
            instances, {}, [&](uint32_t i) { return length_squared(column(scene_.instances[i].world_from_local, 0)); });
        // Near the middle, coordinates of the mesh's space have the precision of its size.
        Bounds3 box;
        for (const uint32_t vertex : mesh.indices) box.extend(mesh.positions[vertex]);
        const Vec3 middle = box.centre();
        std::vector<TreeLight> lights(mesh.triangle_count());
        parallel_for(lights.size(), 4096, [&](uint64_t i) {
            const uint32_t* const index = mesh.indices.data() + 3 * i;
            const Vec3 a = mesh.positions[index[0]];
            const uint32_t light = data_.first_light[largest] + static_cast<uint32_t>(i);
            lights[i] = tree_light(a - middle, mesh.positions[index[1]] - a, mesh.positions[index[2]] - a,
                                   data_.triangles[light], of_triangles_[light]);
        });
        if (count_leaves(lights) < 2) return;
        std::erase_if(instances, [&](uint32_t i) { return !has_lights_of(lights, lights_of(i)); });
        if (instances.size() < 2) return;
        for (const uint32_t i : instances) {
            SharedTreeInstance& instance = to_.instances.emplace_back();
            instance.subtree = static_cast<uint32_t>(to_.shared.size());
            instance.first_light = data_.first_light[i];
            instance.world_from_local = moved_to(scene_.instances[i].world_from_local, centre_);
            instance.world_from_local.translation = transform_point(instance.world_from_local, middle);
            const std::span<TreeLight> own = lights_of(i);
            for (std::size_t k = 0; k < own.size(); ++k) {
                const double power = std::exchange(own[k].power, 0);
                if (!has_leaf(lights[k].power)) continue;
                instance.bounds.extend(own[k].bounds);
                instance.power += power;
            }
        }
        to_.shared.push_back(std::move(lights));
    }

    const Scene& scene_;
    Vec3 centre_;
    const LightSetData& data_;
    std::span<const double> of_triangles_;
    TreeLights to_;
};

} // namespace

TreeLights list_tree_lights(const Scene& scene, Vec3 centre, const LightSetData& data,
                            std::span<const double> of_triangles, std::span<const double> of_punctual) {
    return TreeLightLister(scene, centre, data, of_triangles).list(of_punctual);
}

} // namespace pertev

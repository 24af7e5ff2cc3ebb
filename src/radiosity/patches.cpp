#include "radiosity/patches.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "radiosity/radiosity_settings.h"

namespace pertev {
namespace {

WorldTriangle world_triangle(const SceneView& scene, uint32_t instance, uint32_t primitive, Vec2 uv) {
    const InstanceView& placed = scene.instances[instance];
    return world_triangle(placed, scene.meshes[placed.mesh], {0, uv.x, uv.y, instance, primitive});
}

Vec3 front_of(const SceneView& scene, uint32_t instance, const WorldTriangle& triangle) {
    const InstanceView& placed = scene.instances[instance];
    return front_normal(placed, scene.meshes[placed.mesh], triangle);
}

/// Number of times that a triangle is divided so that no edge is longer than `size`.
uint32_t levels_of(const WorldTriangle& triangle, float size) {
    const float longest = max(length(triangle.ab), max(length(triangle.ac), length(triangle.ac - triangle.ab)));
    uint32_t levels = 0;
    for (float edge = longest; edge > size && levels < 16; edge *= 0.5f) ++levels;
    return levels;
}

float area_of(const WorldTriangle& triangle) { return 0.5f * length(cross(triangle.ab, triangle.ac)); }

bool has_area(const WorldTriangle& triangle) {
    const float area = area_of(triangle);
    return area > 0 && is_finite(area);
}

/// Sets reflectance and exitance of a patch from a few samples of its surface.
void set_surface(const SceneView& scene, Patch& patch) {
    Rgb reflectance, exitance;
    for (uint32_t child = 0; child < 4; ++child) {
        const Vec2 uv = patch.corners.child(child).middle();
        const WorldTriangle triangle = world_triangle(scene, patch, uv);
        const Surface surface =
            make_surface(scene, {0, uv.x, uv.y, patch.instance, patch.primitive}, -normal_of(scene, patch, triangle));
        if (surface.is_unlit) continue; // visible only to the camera
        reflectance += 0.25f * surface.bsdf.diffuse_albedo();
        exitance += (0.25f * kPi) * surface.emission;
    }
    patch.reflectance = reflectance;
    patch.exitance = exitance;
}

struct DividedScene {
    const SceneView& scene;
    WorkWatch* watch; // null: no progress is reported
};

/// Divides `patch` `levels` times. Returns its code; kNoPatch if it has nothing to solve for.
PatchCode divide(const DividedScene& divided, PatchTree& tree, Patch patch, uint32_t levels) {
    if (levels == 0) {
        if (divided.watch != nullptr && divided.watch->is_over()) {
            throw Error(ErrorCode::Interrupted, "interrupted while surfaces were divided into patches; nothing is "
                                                "written, because no light has been solved");
        }
        set_surface(divided.scene, patch);
        tree.patches.push_back(patch);
        return kIsPatch | static_cast<uint32_t>(tree.patches.size() - 1);
    }
    const auto quad = static_cast<uint32_t>(tree.quads.size());
    tree.quads.emplace_back();
    for (uint32_t k = 0; k < 4; ++k) {
        Patch child = patch;
        child.corners = patch.corners.child(k);
        child.area = 0.25f * patch.area;
        const PatchCode code = divide(divided, tree, child, levels - 1);
        tree.quads[quad].child[k] = code;
    }
    return quad;
}

/// Returns whether a material could reflect diffusely or emit.
bool may_count(const MaterialParameters& material) {
    if (material.is_unlit()) return false;
    return material.is_emissive() || material.kind == MaterialKind::Diffuse ||
           material.kind == MaterialKind::MetallicRoughness;
}

/// Calls body for each triangle of the instances that may have patches, judged without their triangles.
template <class Body>
void for_each_triangle(const SceneView& scene, const Body& body) {
    for (uint32_t instance = 0; instance < scene.instance_count; ++instance) {
        const InstanceView& placed = scene.instances[instance];
        if (placed.is_hidden != 0 || !may_count(scene.materials[placed.material])) continue;
        const uint32_t triangles = scene.first_triangle[instance + 1] - scene.first_triangle[instance];
        for (uint32_t primitive = 0; primitive < triangles; ++primitive) {
            const WorldTriangle triangle = world_triangle(scene, instance, primitive, {1.0f / 3, 1.0f / 3});
            if (has_area(triangle)) body(instance, primitive, triangle);
        }
    }
}

} // namespace

WorldTriangle world_triangle(const SceneView& scene, const Patch& patch, Vec2 uv) {
    return world_triangle(scene, patch.instance, patch.primitive, uv);
}

Vec3 normal_of(const SceneView& scene, const Patch& patch, const WorldTriangle& triangle) {
    const Vec3 front = front_of(scene, patch.instance, triangle);
    return patch.side() == 0 ? front : -front;
}

uint32_t hit_side(const SceneView& scene, uint32_t instance, uint32_t primitive, Vec3 direction) {
    const WorldTriangle triangle = world_triangle(scene, instance, primitive, {1.0f / 3, 1.0f / 3});
    return dot(front_of(scene, instance, triangle), direction) < 0 ? 0 : 1;
}

void PatchTree::split(const SceneView& scene, uint32_t number) {
    const Patch patch = patches[number];
    PatchCode* code = &roots[patch.face];
    const Vec2 middle = patch.corners.middle();
    Vec3 weights = {1.0f - middle.x - middle.y, middle.x, middle.y};
    while (*code < kIsPatch) code = &quads[*code].child[PatchTreeView::descend(weights)];
    PERTEV_CHECK(*code == (kIsPatch | number));
    *code = static_cast<uint32_t>(quads.size());
    PatchQuad quad;
    for (uint32_t k = 0; k < 4; ++k) {
        Patch child = patch;
        child.corners = patch.corners.child(k);
        child.area = 0.25f * patch.area;
        set_surface(scene, child);
        quad.child[k] = kIsPatch | (k == 0 ? number : static_cast<uint32_t>(patches.size()));
        if (k == 0) {
            patches[number] = child;
        } else {
            patches.push_back(child);
        }
    }
    quads.push_back(quad);
}

uint64_t count_patches(const SceneView& scene, float patch_size) {
    uint64_t count = 0;
    for_each_triangle(scene, [&](uint32_t, uint32_t, const WorldTriangle& triangle) {
        count += uint64_t(2) << (2 * levels_of(triangle, patch_size));
    });
    return count;
}

void check_patch_count(uint64_t patches, float patch_size) {
    if (patches <= kMaxPatches) return;
    throw Error(ErrorCode::OverLimit, "patch_size", fmt::format("{}", patch_size),
                fmt::format("this scene would have {} patches; the limit is {}", patches, kMaxPatches));
}

PatchTree make_patches(const SceneView& scene, float patch_size, WorkWatch* watch) {
    const uint64_t most = count_patches(scene, patch_size);
    check_patch_count(most, patch_size);
    if (watch != nullptr) watch->begin("patches", most);
    PatchTree tree;
    tree.patches.reserve(most);
    tree.quads.reserve(most / 3);
    tree.roots.assign(2 * scene.triangle_count, kNoPatch);
    bool any_reflects = false;
    for_each_triangle(scene, [&](uint32_t instance, uint32_t primitive, const WorldTriangle& triangle) {
        for (uint32_t side = 0; side < 2; ++side) {
            Patch patch;
            patch.instance = instance;
            patch.primitive = primitive;
            patch.face = face_of(scene, instance, primitive, side);
            patch.area = area_of(triangle);
            const std::size_t first = tree.patches.size(), first_quad = tree.quads.size();
            tree.roots[patch.face] = divide({scene, watch}, tree, patch, levels_of(triangle, patch_size));
            if (watch != nullptr) watch->done(uint64_t(1) << (2 * levels_of(triangle, patch_size)));
            bool counts = false;
            for (std::size_t i = first; i < tree.patches.size(); ++i) {
                const bool reflects = !is_black(tree.patches[i].reflectance);
                any_reflects = any_reflects || reflects;
                counts = counts || reflects || !is_black(tree.patches[i].exitance);
            }
            if (counts) continue;
            tree.patches.resize(first);
            tree.quads.resize(first_quad);
            tree.roots[patch.face] = kNoPatch;
        }
    });
    if (!any_reflects) {
        throw Error(ErrorCode::BadInput, "scene", "",
                    "no surface of this scene reflects diffusely, so there is nothing to solve (`integrator=path` "
                    "supports mirrors, glass and unlit surfaces)");
    }
    return tree;
}

} // namespace pertev

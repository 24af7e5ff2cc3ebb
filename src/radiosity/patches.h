#pragma once

// The patches of a scene: both sides of its triangles, divided until no edge exceeds the patch size, each with the
// mean reflectance and exitance of its surface. Sides that neither reflect diffusely nor emit have none; light is
// absorbed there.
//
// Source: Goral, Torrance, Greenberg, Battaile, "Modeling the Interaction of Light Between Diffuse Surfaces", SIGGRAPH
// 1984, section 3.

#include <cstdint>
#include <vector>

#include "device_scene/scene_view.h"
#include "device_scene/surface.h"
#include "math/rgb.h"
#include "radiosity/patch_tree.h"
#include "radiosity/work_watch.h"

namespace pertev {

struct Patch {
    uint32_t instance = 0, primitive = 0;
    uint32_t face = 0; // 2 t + side
    PatchCorners corners;
    float area = 0;  // m2
    Rgb reflectance; // [0, 1]
    Rgb exitance;    // own emission, W/m2

    uint32_t side() const { return face % 2; }
};

struct PatchTree {
    std::vector<PatchCode> roots; // [faces]
    std::vector<PatchQuad> quads;
    std::vector<Patch> patches;

    PatchTreeView view() const { return {roots.data(), quads.data()}; }
    /// Divides patch `number` into four: the first child takes its number, the others the next free ones.
    void split(const SceneView& scene, uint32_t number);
};

/// Triangle of a patch, with the point at `uv` on it.
WorldTriangle world_triangle(const SceneView& scene, const Patch& patch, Vec2 uv);
/// Unit normal of the patch's side.
Vec3 normal_of(const SceneView& scene, const Patch& patch, const WorldTriangle& triangle);
/// Side of a triangle at which a ray along `direction` arrives.
uint32_t hit_side(const SceneView& scene, uint32_t instance, uint32_t primitive, Vec3 direction);
/// Number of the face of a hit.
inline uint32_t face_of(const SceneView& scene, uint32_t instance, uint32_t primitive, uint32_t side) {
    return 2 * (scene.first_triangle[instance] + primitive) + side;
}

/// Maximum number of patches that make_patches makes: both sides of each triangle, whatever their material.
uint64_t count_patches(const SceneView& scene, float patch_size);

/// Checks a number of patches. Throws Error(OverLimit) for more than kMaxPatches.
void check_patch_count(uint64_t patches, float patch_size);

/// Divides a scene into patches. `scene` is in host memory and numbers its triangles. Throws Error(OverLimit) for more
/// than kMaxPatches; Error(BadInput) if none reflects, because there is nothing to solve; Error(Interrupted) if `watch`
/// is over.
PatchTree make_patches(const SceneView& scene, float patch_size, WorkWatch* watch = nullptr);

} // namespace pertev

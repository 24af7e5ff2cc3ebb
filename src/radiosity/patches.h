#pragma once

// The patches of a scene: both sides of its triangles, divided until no edge is longer than asked for, each with a
// reflectance and an exitance that are the mean of what its surface has there. Sides that neither reflect diffusely nor
// emit have none: light ends there.
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
    Rgb exitance;    // by itself, W/m2

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

/// The triangle that a patch is part of, with a place on it.
PlacedTriangle place_on(const SceneView& scene, const Patch& patch, Vec2 place);
/// Unit, out of the patch's side.
Vec3 normal_of(const SceneView& scene, const Patch& patch, const PlacedTriangle& triangle);
/// Which side of a triangle a ray along `direction` arrives at.
uint32_t side_met(const SceneView& scene, uint32_t instance, uint32_t primitive, Vec3 direction);
/// Number of the face at a hit.
inline uint32_t face_of(const SceneView& scene, uint32_t instance, uint32_t primitive, uint32_t side) {
    return 2 * (scene.first_triangle[instance] + primitive) + side;
}

/// Patches at most that make_patches makes: both sides of each triangle, whatever they are made of.
uint64_t count_patches(const SceneView& scene, float patch_size);

/// Throws Error(OverLimit) for more than kMostPatches.
void check_patch_count(uint64_t patches, float patch_size);

/// `scene` lies in the host's memory and numbers its triangles. Throws Error(OverLimit) where there are more than
/// kMostPatches; Error(BadInput) where none of them reflects: there is nothing to solve.
/// Error(Interrupted) where `watch` is over.
PatchTree make_patches(const SceneView& scene, float patch_size, WorkWatch* watch = nullptr);

} // namespace pertev

#pragma once

// Interfaces of solids that lie in each other. A path, or a ray of a tree, carries the solids that hold it; a surface
// it reaches has their index on one side. Scenes without such solids do not call this.

#include "device_scene/interior_list.h"
#include "device_scene/solid_absorption.h"
#include "device_scene/surface.h"

namespace pertev {

/// Returns the solids before a surface of `instance` that a ray reaches, which `list` followed so far. The surface
/// corrects the list: what is entered was not around the ray, and what is left was.
HD_CALL inline InteriorList solids_before(const SceneView& scene, InteriorList list, uint32_t instance, bool enters) {
    const uint32_t rank = scene.nesting.ranks[instance];
    if (rank == 0) return list;
    return enters ? list.without(rank) : list.with(rank);
}
/// Returns the solids on the other side of a surface.
HD_CALL inline InteriorList solids_behind(const SceneView& scene, InteriorList before, uint32_t instance) {
    const uint32_t rank = scene.nesting.ranks[instance];
    if (rank == 0) return before;
    return before.has(rank) ? before.without(rank) : before.with(rank);
}

/// Returns the number of the material that fills a point within a solid.
HD inline uint32_t material_of_solid(const SceneView& scene, InteriorList list) {
    return scene.instances[scene.nesting.solids[list.top()]].material;
}

/// Returns the index of refraction of what fills a point, over that of a vacuum.
HD_CALL inline float ior_within(const SceneView& scene, InteriorList list) {
    float ior = 1;
    while (list.top() != 0) {
        const MaterialParameters& material = scene.materials[material_of_solid(scene, list)];
        ior *= material.ior;
        if (!material.has_relative_ior) break;
        list = list.without(list.top()); // the next one surrounds it
    }
    return ior;
}

/// Returns the transmittance of `distance` metres through what fills the solids of `list`; 1 outside of all solids, or
/// if `distance` is infinite.
HD_CALL inline Rgb transmittance_within(const SceneView& scene, InteriorList list, float distance) {
    if (list.top() == 0) return {1, 1, 1};
    const MaterialParameters& solid = scene.materials[material_of_solid(scene, list)];
    return solid.absorbs() ? transmittance_of_depth(solid, distance) : Rgb{1, 1, 1};
}

/// Returns the transmittance of the ray from `start` that found `hit`; a solid that is not nested absorbs as in a scene
/// without nested solids.
HD inline Rgb transmittance_to_surface(const SceneView& scene, InteriorList list, TriangleId start, Vec3 direction,
                                       const Hit& hit, float time) {
    if (list.top() != 0) return transmittance_within(scene, list, hit.t);
    return transmittance_of_solid(scene, start, {hit.instance, hit.primitive}, direction, hit.t, time);
}

/// Changes the BSDF of a solid's surface: to nothing where a solid of a greater rank fills both sides, else to an
/// interface with what is outside. A coat, and the reflection on an opaque share, stay those in a vacuum.
HD_CALL inline void nest_surface(const SceneView& scene, InteriorList before, Surface& surface) {
    const uint32_t rank = scene.nesting.ranks[surface.triangle.instance];
    if (rank == 0) return;
    Bsdf& bsdf = surface.bsdf;
    const InteriorList outside = before.without(rank);
    if (outside.top() > rank) {
        bsdf = make_dielectric(1, 0, {1, 1, 1});
        bsdf.is_called = true;
        return;
    }
    const MaterialParameters& material = scene.materials[surface.material];
    if (outside.top() == 0 || material.has_relative_ior) return;
    const float around = ior_within(scene, outside), scale = 1.0f / around, ior = material.ior / around;
    if (bsdf.base.kind == LobeKind::Dielectric) {
        bsdf.base.dielectric.ior = DielectricLobe::usable_ior(ior, bsdf.base.dielectric.alpha);
    }
    for (int i = 0; i < bsdf.layer_count; ++i) {
        if (bsdf.layers[i].kind != LobeKind::Glass) continue;
        PackedGlassLobe& glass = bsdf.layers[i].glass;
        glass.ior = DielectricLobe::usable_ior(ior, glass.surface.widths().y);
        glass.spread = scale * glass.spread;
    }
}

} // namespace pertev

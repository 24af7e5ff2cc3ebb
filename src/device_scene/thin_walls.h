#pragma once

// Thin walls, such as panes of smooth glass, that light passes straight. A shadow ray of a path passes them, and its
// light is multiplied by what each lets through, because otherwise no light of the sun or of a point would come through
// a window, and that of large emitters only by chance. A path that goes straight through a wall keeps the
// density and the vertex by which next-event estimation could have found what it meets then (path_vertex.h), so that
// the two are weighted against each other as without the wall.
//
// A wall is a null interaction, as in Miller, Georgiev, Jarosz, "A Null-Scattering Path Integral Formulation of Light
// Transport", ACM TOG 38(4), 2019, with a transmittance that is known.

#include "device_scene/next_crossing.h"
#include "device_scene/surface.h"

namespace pertev {

/// Returns the share of the light that goes straight through a wall where a ray along `direction` (unit) crosses it.
HD_CALL inline Rgb transmittance_of_thin_wall(const SceneView& scene, const SurfaceCrossing& crossing, Vec3 direction) {
    const uint32_t primitive = scene.thin_walls.triangles[crossing.number].primitive;
    const Surface surface =
        make_surface(scene, {crossing.distance, crossing.u, crossing.v, crossing.instance, primitive}, direction);
    const Vec3 wo = surface.frame.to_local(-direction);
    const SpecularBranches branches = surface.bsdf.specular(wo);
    return branches.refracted == -wo ? branches.refraction : Rgb{0, 0, 0};
}

/// Calls `visit` with each crossing of a thin wall on a ray up to `distance`, in multiples of its direction's length,
/// in order, until it returns true.
template <class Visit>
HD inline void visit_thin_walls(const SceneView& scene, Vec3 origin, Vec3 direction, float distance,
                                const Visit& visit) {
    SurfaceCrossing crossing;
    while (find_next_crossing(scene.thin_walls, origin, direction, distance, crossing)) {
        if (visit(crossing)) return;
    }
}

/// The thin walls on a ray.
struct PassedWalls {
    Rgb transmittance = {1, 1, 1}; // product over all; black as soon as one lets nothing through
    uint32_t count = 0;
};
HD_CALL inline PassedWalls pass_thin_walls(const SceneView& scene, const Ray& ray) {
    PassedWalls walls;
    const Vec3 direction = normalize(ray.direction);
    visit_thin_walls(scene, ray.origin, ray.direction, ray.t_max, [&](const SurfaceCrossing& crossing) {
        walls.transmittance = walls.transmittance * transmittance_of_thin_wall(scene, crossing, direction);
        ++walls.count;
        return is_black(walls.transmittance);
    });
    return walls;
}

} // namespace pertev

#pragma once

// The media that a ray passes: that of the solid which fills each part of it (nested_solids.h), or the scene's own
// where there is none. Clear boundaries divide a ray into parts; at other surfaces it ends.

#include "device_scene/nested_solids.h"
#include "device_scene/next_crossing.h"

namespace pertev {

/// A part of a ray that lies in one medium: that of a solid's material, or of SceneView::surroundings.
struct RayPart {
    const MaterialParameters& material;
    float begin, end; // in multiples of the direction's length
};

/// Calls `visit` for each part of a ray up to `distance`, in order, until it returns true. `list` has the solids that
/// hold the ray's origin, and afterwards those that hold the end of the last part visited. A ray that leaves the scene
/// (`leaves`) ends in the scene's own medium, whatever its list says: rounding may have missed a surface.
template <class Visit>
HD inline void visit_media(const SceneView& scene, InteriorList& list, Vec3 origin, Vec3 direction, float distance,
                           bool leaves, const Visit& visit) {
    SurfaceCrossing crossing;
    float begin = 0;
    for (;;) {
        const bool crosses =
            scene.boundaries.is_there() && find_next_crossing(scene.boundaries, origin, direction, distance, crossing);
        if (crosses) list = solids_before(scene, list, crossing.instance, crossing.enters);
        if (!crosses && leaves) list = {};
        // Neither pointer is null, because ptxas 13.0 compares one that may be null too early (tools/check_stalls.py).
        const MaterialParameters& material =
            *(list.top() == 0 ? scene.surroundings : scene.materials + material_of_solid(scene, list));
        const float end = crosses ? crossing.distance : distance;
        if (visit(RayPart{material, begin, end}) || !crosses) return;
        list = solids_behind(scene, list, crossing.instance);
        begin = end;
    }
}

/// Returns the optical depth of `distance` metres, which may not end, for each colour.
HD inline Rgb optical_depth(Rgb sigma, float distance) {
    const auto of = [&](float rate) { return rate > 0 ? rate * distance : 0.0f; };
    return {of(sigma.r), of(sigma.g), of(sigma.b)};
}
HD inline Rgb transmittance_of(Rgb optical_depth) {
    return {exp(-optical_depth.r), exp(-optical_depth.g), exp(-optical_depth.b)};
}

/// Returns the transmittance of `distance` metres by the absorption of the part's solid, without its medium's.
HD inline Rgb absorption_of(const RayPart& part, float distance) {
    if (!part.material.absorbs()) return {1, 1, 1};
    return transmittance_of_depth(part.material, distance);
}

/// Returns the transmittance of a ray with a unit direction over `distance` metres; `list` has the solids that hold its
/// origin.
HD_CALL inline Rgb transmittance_of_media(const SceneView& scene, InteriorList list, Vec3 origin, Vec3 direction,
                                          float distance) {
    Rgb depth = {0, 0, 0}, absorbed = {1, 1, 1};
    visit_media(scene, list, origin, direction, distance, !(distance < kInfinity), [&](const RayPart& part) {
        const float length = part.end - part.begin;
        depth += optical_depth(part.material.medium.sigma_t(), length);
        absorbed = absorbed * absorption_of(part, length);
        return false;
    });
    return absorbed * transmittance_of(depth);
}

/// Returns the transmittance of a ray whose direction may have any length, up to its t_max.
HD inline Rgb transmittance_of_media(const SceneView& scene, InteriorList list, const Ray& ray) {
    const float size = length(ray.direction);
    return transmittance_of_media(scene, list, ray.origin, ray.direction / size, size * ray.t_max);
}

} // namespace pertev

#pragma once

// The solids that hold the beginning of a ray from a light, in a scene with media. The host finds those of one point of
// each light (NestingView::of_lights); from there to where the ray begins, clear boundaries are crossed, no others.

#include "device_scene/media_along_ray.h"

namespace pertev {

/// Returns a point just before the front of a triangle light, which may lie in the boundary of a medium.
HD inline Vec3 point_before(const EmissiveTriangle& triangle) {
    const Vec3 normal = cross(triangle.ab, triangle.ac);
    const float area = length(normal), side = triangle.is_mirrored != 0 ? -1.0f : 1.0f;
    const Vec3 offset = area > 0 ? (0x1p-13f * side / sqrt(area)) * normal : Vec3{0, 0, 0};
    return triangle.middle() + offset;
}

/// Returns the solids that hold the origin of a ray that leaves a light. Lights with a position are numbered as in
/// NestingView::of_lights; kNoLight is one at infinity. `start` is the light's triangle if the light is a triangle.
HD inline InteriorList interior_of_light(const SceneView& scene, uint32_t light, TriangleId start, Vec3 origin,
                                         Vec3 direction) {
    if (light == kNoLight || scene.nesting.of_lights == nullptr) return {};
    InteriorList list = InteriorList::of_words(scene.nesting.of_lights[light]);
    if (light >= scene.lights.triangle_count) return list;
    const Vec3 from = point_before(scene.lights.triangles[light]), offset = origin - from;
    const float distance = length(offset);
    if (distance > 0) {
        visit_media(scene, list, from, offset / distance, distance, false, [](const RayPart&) { return false; });
    }
    const uint32_t rank = scene.nesting.ranks[start.instance];
    if (rank == 0) return list;
    return points_inwards(scene, start, direction, kAtRest) ? list.with(rank) : list.without(rank);
}

} // namespace pertev

#pragma once

// Finds the crossings of a ray with the surfaces of a tree (crossed_surfaces.h) one after the other.

#include "device_scene/crossed_surfaces.h"
#include "trace/traverse_scene.h"

namespace pertev {

/// A ray's crossing of a surface. Two at one distance are ordered by their triangles.
struct SurfaceCrossing {
    float distance = 0;  // in multiples of the direction's length
    float u = 0, v = 0;  // weights of the triangle's second and third vertex
    uint32_t number = 0; // number of the triangle
    uint32_t instance = kNoHit;
    bool enters = false; // from the front
};

/// Visitor of a traversal for the first crossing after another one.
struct NextCrossingVisitor {
    float after;
    uint32_t after_number;
    bool is_first;
    Hit best;

    HD float limit() const { return best.t; }
    HD static constexpr bool visits_far_first() { return false; }
    HD bool visit(uint32_t, uint32_t number, const TriangleHit& hit) {
        const bool is_later = is_first || hit.t > after || (hit.t == after && number > after_number);
        const bool is_nearer = hit.t < best.t || (hit.t == best.t && number < best.primitive);
        if (is_later && is_nearer) best = {hit.t, hit.u, hit.v, 0, number};
        return false;
    }
};

/// Finds the first crossing of the ray after `crossing`, whose instance is kNoHit at first, and before `distance`.
/// Returns false if there is none.
HD_CALL inline bool find_next_crossing(const CrossedSurfacesView& surfaces, Vec3 origin, Vec3 direction, float distance,
                                       SurfaceCrossing& crossing) {
    const bool is_first = crossing.instance == kNoHit;
    // Boxes that end at the former crossing must not be culled.
    const float from = is_first ? 0.0f : (1.0f - 0x1p-20f) * crossing.distance;
    NextCrossingVisitor visitor = {crossing.distance, crossing.number, is_first, {}};
    visitor.best.t = distance;
    PlainTraversal::traverse(surfaces.tree, {origin, from, direction, distance}, 0, visitor, NoTraversalCounter{});
    const Hit& best = visitor.best;
    if (best.instance == kNoHit) return false;
    const CrossedTriangle& triangle = surfaces.triangles[best.primitive];
    const bool enters = dot(direction, triangle.normal) < 0;
    crossing = {best.t, best.u, best.v, best.primitive, triangle.instance, enters};
    return true;
}

} // namespace pertev

#pragma once

// Shades the vertices of eight or, on processors with AVX-512, sixteen paths at once on the host, where diffuse
// materials at rest are under plain light (SceneView::has_plain_light), with the bits that shade_vertex (path_vertex.h)
// gives for each path alone. Other vertices, and those that listeners want to see, are shaded one by one.

#include <array>

#include "base/processor.h"
#include "integrators/path/path_job.h"
#include "integrators/path/path_state.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Paths that have hit surfaces, in a caller's arrays; at most as many as there are lanes. Lanes from `count` on repeat
/// a path.
struct LaneVertices {
    uint32_t count;
    std::array<PathState*, kMaxLanes> paths;
    std::array<const Hit*, kMaxLanes> hits;
};

/// Results of vertices; one bit for each lane, that of lane 0 first.
struct LaneResults {
    unsigned goes_on = 0;        // the path continues; it has been moved to its next ray
    unsigned has_shadow_ray = 0; // has a shadow ray
};

/// A function that shades vertices, and the number of vertices that it takes at a time.
struct VertexShading {
    uint32_t lanes;
    /// Shades vertices of a job for which can_shade_lanes holds, on materials for which it holds. Stores the shadow
    /// rays of lanes that need one, one after the other, from `shadows` on.
    LaneResults (*shade)(const PathJob& job, const LaneVertices& vertices, ShadowRay* shadows);
};

extern const VertexShading kShadingOf8;
#if defined(PERTEV_HAS_16_LANES)
extern const VertexShading kShadingOf16;
#endif

/// Returns the function for the widest lanes that this computer's processor has.
const VertexShading& vertex_shading();

/// Returns whether `shade` may be called for the job, for vertices on some materials.
bool can_shade_lanes(const PathJob& job);

/// Returns whether vertices on the material may be shaded in lanes: it is diffuse, also with a texture of its colour
/// and a normal map.
inline bool can_shade_lanes(const MaterialParameters& material) {
    return material.kind == MaterialKind::Diffuse && !material.is_stacked() && !material.emission_texture.has_image();
}

} // namespace pertev

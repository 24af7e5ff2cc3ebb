#pragma once

// Shades the vertices of eight or, on processors with AVX-512, sixteen paths at once on the host, on diffuse and rough
// metallic-roughness materials at rest, with the bits that shade_vertex (path_vertex.h) gives for each path alone.
// Other vertices, and those that listeners want to see, are shaded one by one.

#include <array>

#include "base/processor.h"
#include "device_scene/make_bsdf.h"
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
    /// Both shade vertices of a job for which can_shade_lanes holds, whose lane_lobes() are Diffuse or Glossy. They
    /// store the shadow rays of lanes that need one, one after the other, from `shadows` on.
    LaneResults (*shade_diffuse)(const PathJob& job, const LaneVertices& vertices, ShadowRay* shadows);
    LaneResults (*shade_glossy)(const PathJob& job, const LaneVertices& vertices, ShadowRay* shadows);
};

extern const VertexShading kShadingOf8;
#if defined(PERTEV_HAS_16_LANES)
extern const VertexShading kShadingOf16;
#endif

/// Returns the function for the widest lanes that this computer's processor has.
const VertexShading& vertex_shading();

/// Returns whether vertices of the job may be shaded in lanes, where lane_lobes() says so.
bool can_shade_lanes(const PathJob& job);

/// Lobes that lanes shade, with textures and normal maps.
enum class LaneLobes : uint8_t { None, Diffuse, Glossy };

/// Returns the GGX width of metallic-roughness at a hit.
inline float ggx_width_at(const SceneView& scene, const Hit& hit) {
    const InstanceView& instance = scene.instances[hit.instance];
    const MeshView& mesh = scene.meshes[instance.mesh];
    const MaterialParameters& material = scene.materials[instance.material];
    return alpha_from_roughness(textured_factor(scene, mesh, material.roughness, material.roughness_texture,
                                                triangle_indices(mesh, hit.primitive), hit.u, hit.v));
}

/// Returns the lobes as which lanes shade a path's hit: one diffuse lobe, or a reflection that is not smooth on
/// another, where no solid absorbs on the way. The path stays in the solids that hold it there.
inline LaneLobes lane_lobes(const SceneView& scene, const PathState& path, const Hit& hit) {
    if (scene.variant == ShadingVariant::PlainDiffuse) return LaneLobes::Diffuse;
    const MaterialParameters& material = scene.materials[scene.instances[hit.instance].material];
    const bool is_glossy = material.kind == MaterialKind::MetallicRoughness;
    if (!(is_glossy || material.kind == MaterialKind::Diffuse) || material.is_stacked()) return LaneLobes::None;
    if (scene.nesting.is_there() && scene.nesting.ranks[hit.instance] != 0) return LaneLobes::None;
    if (scene.absorption != SolidAbsorption::None) {
        const uint32_t before = path.start.instance;
        if (path.interior.top() != 0) return LaneLobes::None;
        if (before != kNoHit && scene.materials[scene.instances[before].material].absorbs()) return LaneLobes::None;
    }
    if (!is_glossy) return LaneLobes::Diffuse;
    return ggx_width_at(scene, hit) >= kSmoothAlpha ? LaneLobes::Glossy : LaneLobes::None;
}

} // namespace pertev

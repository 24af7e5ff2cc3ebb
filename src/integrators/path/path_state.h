#pragma once

// One path between two stages, and the shadow ray that a stage asks for.

#include <cstdint>

#include "device_scene/accept_hit.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/sampler.h"
#include "render/camera_rays.h"
#include "trace/intersect/ray.h"

namespace pertev {

struct PathState {
    Vec3 origin, direction; // of the ray to trace next; unit direction
    Rgb throughput = {1, 1, 1};
    Rgb radiance = {0, 0, 0}; // gathered so far
    float bsdf_pdf = 0;       // density with which `direction` was drawn, 1/sr; 0 after the camera or a delta lobe
    uint32_t pixel = 0, sample = 0;
    TriangleId start;         // triangle that the ray leaves
    Vec3 normal = {0, 0, 0};  // of the context that chose a light there, where LightChoice reads it; zero: none
    uint32_t depth = 0;       // scattering vertices so far
    uint32_t rough_depth = 0; // of which not delta
    float time = kAtRest;     // of all of its rays, while the shutter is open
};

/// Asked for by sample_direct: `contribution` counts if nothing stands between origin and origin + direction * t_max.
struct ShadowRay {
    Vec3 origin, direction;
    float t_max = 0;
    TriangleId start;  // triangle that the ray leaves
    TriangleId target; // the light's triangle
    Rgb contribution;
};

/// Random numbers of a path, in groups of four (math/sampler.h). The places of numbers that nothing draws yet are kept:
/// a feature that will draw them changes no picture without it.
///   camera         place in the pixel, then the light of vertex 0
///   lens           place on the lens, time, one kept
///   scatter, of v  direction from vertex v, then the light of vertex v + 1: both decide what v gathers over one bounce
///   choices, of v  lobe, roulette, class of the scattering in light-path expressions, one kept for lobes
inline constexpr uint32_t kGroupFirstVertex = kCameraGroups;
enum VertexGroup : uint32_t { kGroupScatter, kGroupChoices, kGroupsPerVertex };
inline constexpr uint32_t kNumberLobe = 0, kNumberRoulette = 1, kNumberLightPath = 2;

/// `depth`: of one path or of eight (math/random.h), as PathState has it.
template <class Word>
HD inline Word vertex_group(Word depth, VertexGroup group) {
    return depth * uint32_t(kGroupsPerVertex) + (kGroupFirstVertex + group);
}

/// The group whose last pair draws the light of the path's vertex.
template <class Word>
HD inline Word vertex_light_group(Word depth) {
    const Word from_camera = Word{} + uint32_t(kGroupCamera);
    return depth == 0u ? from_camera : vertex_group(depth - 1u, kGroupScatter);
}

/// The coin of blended surfaces for a path's ray at its depth; shadow rays toss another one.
HD inline uint32_t path_key(const PathState& path, uint32_t seed, bool is_shadow) {
    return coin_key({path.pixel, path.sample, seed}, path.depth, is_shadow);
}

} // namespace pertev

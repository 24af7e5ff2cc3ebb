#pragma once

// The state of a path between two stages, and the shadow ray of a stage.

#include <cstdint>

#include "device_scene/accept_hit.h"
#include "math/float4.h"
#include "math/rgb.h"
#include "math/sampler.h"
#include "render/camera_rays.h"
#include "trace/intersect/ray.h"

namespace pertev {

struct PathState {
    Vec3 origin, direction; // ray to trace next; unit direction
    Rgb throughput = {1, 1, 1};
    Rgb radiance = {0, 0, 0}; // sum so far
    float bsdf_pdf = 0;       // density with which `direction` was sampled, 1/sr; 0 after the camera or a delta lobe,
                              // or minus the width of the ray's cone there, metres (cone_width)
    uint32_t pixel = 0, sample = 0;
    TriangleId start;         // triangle that the ray leaves
    Vec3 normal = {0, 0, 0};  // normal of the context that selected a light there, if LightChoice reads it; else zero
    float passed = 0;         // metres from where `direction` was sampled to `origin`, straight through thin walls
    uint32_t depth = 0;       // scattering vertices so far
    uint32_t rough_depth = 0; // scatterings so far that were not delta
    float time = kAtRest;     // time of all its rays while the shutter is open
    InteriorList interior;    // nested solids that hold the ray, if any are nested
};

/// A shadow ray of sample_direct: `contribution` counts if nothing is hit between origin and origin + direction *
/// t_max.
struct ShadowRay {
    Vec3 origin, direction;
    float t_max = 0;
    TriangleId start;  // triangle that the ray leaves
    TriangleId target; // the light's triangle
    Rgb contribution;
};

/// Random numbers of a path, in groups of four (math/sampler.h). Unused numbers are reserved, so that a feature that
/// will use them changes no picture without it.
///   camera         position in the pixel, then the light of vertex 0
///   lens           position on the lens, time, one reserved
///   scatter, of v  direction from vertex v, then the light of vertex v + 1: both decide what v gathers over one bounce
///   choices, of v  lobe, roulette, class of the scattering in light-path expressions, one reserved for lobes
inline constexpr uint32_t kGroupFirstVertex = kCameraGroups;
enum VertexGroup : uint32_t { kGroupScatter, kGroupChoices, kGroupsPerVertex };
inline constexpr uint32_t kNumberLobe = 0, kNumberRoulette = 1, kNumberLightPath = 2;

/// Group of a vertex; `depth` as in PathState, for one path or for eight (math/random.h).
template <class Word>
HD inline Word vertex_group(Word depth, VertexGroup group) {
    return depth * uint32_t(kGroupsPerVertex) + (kGroupFirstVertex + group);
}

/// The group whose last pair samples the light of the path's vertex.
template <class Word>
HD inline Word vertex_light_group(Word depth) {
    const Word from_camera = Word{} + uint32_t(kGroupCamera);
    return depth == 0u ? from_camera : vertex_group(depth - 1u, kGroupScatter);
}

} // namespace pertev

#pragma once

// One path between two stages, and the shadow ray that a stage asks for.

#include <cstdint>

#include "math/rgb.h"
#include "math/sampler.h"
#include "render/accept_hit.h"
#include "trace/ray.h"

namespace pertev {

struct PathState {
    Vec3 origin, direction; // of the ray to trace next; unit direction
    Rgb throughput = {1, 1, 1};
    Rgb radiance = {0, 0, 0}; // gathered so far
    float bsdf_pdf = 0;       // density with which `direction` was drawn, 1/sr; 0 after the camera or a delta lobe
    uint32_t pixel = 0, sample = 0;
    TriangleId start;         // triangle that the ray leaves
    uint32_t depth = 0;       // scattering vertices so far
    uint32_t rough_depth = 0; // of which not delta
};

/// Asked for by shade_hit: `contribution` counts if nothing stands between origin and origin + direction * t_max.
struct ShadowRay {
    Vec3 origin, direction;
    float t_max = 0;
    TriangleId target; // the light's triangle
    Rgb contribution;
};

/// Random numbers of a path: one slot a decision. A slot is one dimension pair of the sampler.
enum SampleSlot : uint32_t { kSlotFilter, kSlotLens, kSlotFirstVertex };
enum VertexSlot : uint32_t { kSlotLight, kSlotOnLight, kSlotLobe, kSlotBsdf, kSlotRoulette, kSlotsPerVertex };

HD inline uint32_t vertex_slot(const PathState& path, VertexSlot slot) {
    return kSlotFirstVertex + path.depth * kSlotsPerVertex + slot;
}

/// The coin of blended surfaces for a path's ray at its depth; shadow rays toss another one.
HD inline uint32_t path_key(const PathState& path, uint32_t seed, bool is_shadow) {
    return hash_words(path.pixel, path.sample, seed, path.depth * 2 + (is_shadow ? 1u : 0u)).x;
}

} // namespace pertev

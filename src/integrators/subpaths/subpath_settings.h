#pragma once

// Settings of integrators with light subpaths, besides scene and camera, and the random numbers of their subpaths.

#include <cstdint>

#include "math/sampler.h"
#include "math/vec3.h"
#include "render/camera_rays.h"
#include "shading/light_selection.h"

namespace pertev {

struct SubpathSettings {
    uint32_t max_depth = 16;     // scatterings between light and camera
    uint32_t roulette_depth = 3; // first vertex of a subpath (counted from 1) at which Russian roulette may end it
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;
    LightSelection light_choice =
        LightSelection::Power; // next-event estimation has it; particles leave lights by power

    bool operator==(const SubpathSettings&) const = default;
};

/// Largest max_depth of `integrator=bidirectional`, because vertices of light subpaths are stored, 48 to 56 bytes each.
inline constexpr uint32_t kMaxConnectedDepth = 255;

/// Random numbers of a camera subpath, in groups of four (math/sampler.h), as in path tracing:
///   camera         position in the pixel, then the light of vertex 0
///   lens           position on the lens
///   scatter, of v  direction from vertex v, then the light of vertex v + 1
///   choices, of v  lobe, roulette
/// Random numbers of a light subpath:
///   light          the light and the point on it, then the direction
///   scatter, of v  direction from vertex v, then the point on the lens that it connects to
///   choices, of v  lobe, roulette
enum SubpathGroup : uint32_t { kSubpathScatter, kSubpathChoices, kSubpathGroups };
inline constexpr uint32_t kNumberOfLobe = 0, kNumberOfRoulette = 1;
inline constexpr uint32_t kGroupLight = 1u << 20; // beyond all groups of camera subpaths

HD inline uint32_t camera_group(uint32_t depth, SubpathGroup of) { return kCameraGroups + depth * kSubpathGroups + of; }
HD inline uint32_t particle_group(uint32_t depth, SubpathGroup of) {
    return kGroupLight + 1 + depth * kSubpathGroups + of;
}
/// The group whose last pair samples the light of the camera subpath's vertex.
HD inline uint32_t light_group(uint32_t depth) {
    return depth == 0 ? uint32_t(kGroupCamera) : camera_group(depth - 1, kSubpathScatter);
}

/// Offsets of the coin keys of blended surfaces, one for each kind of ray of a subpath.
inline constexpr uint32_t kCameraCoins = 0, kParticleCoins = 0x9e3779b9u, kConnectionCoins = 0x7f4a7c15u;

} // namespace pertev

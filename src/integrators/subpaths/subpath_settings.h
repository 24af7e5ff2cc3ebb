#pragma once

// What integrators that walk from the lights are asked for, beside scene and camera, and the random numbers of their
// walks.

#include <cstdint>

#include "math/sampler.h"
#include "math/vec3.h"
#include "render/camera_rays.h"

namespace pertev {

struct SubpathSettings {
    uint32_t max_depth = 16;     // scatterings between light and camera
    uint32_t roulette_depth = 3; // first vertex of a walk (counted from 1) at which Russian roulette may end it
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;

    bool operator==(const SubpathSettings&) const = default;
};

/// The largest max_depth of `integrator=bidirectional`: vertices of the walks from the lights are kept, 48 bytes each.
inline constexpr uint32_t kMostJoinedDepth = 255;

/// A sphere round all that rays can meet, the moved world: light from far away comes through its discs.
struct WorldSphere {
    Vec3 centre;
    float radius = 0; // metres; 0: there is nothing
};

/// Random numbers of a walk from the camera, in groups of four (math/sampler.h), as path tracing draws them:
///   camera         place in the pixel, then the light of vertex 0
///   lens           place on the lens
///   scatter, of v  direction from vertex v, then the light of vertex v + 1
///   choices, of v  lobe, roulette
/// Of a walk from a light:
///   light          the light and the place on it, then the direction
///   scatter, of v  direction from vertex v, then the place on the lens that looks at it
///   choices, of v  lobe, roulette
enum WalkGroup : uint32_t { kWalkScatter, kWalkChoices, kWalkGroups };
inline constexpr uint32_t kNumberOfLobe = 0, kNumberOfRoulette = 1;
inline constexpr uint32_t kGroupLight = 1u << 20; // beyond all groups of walks from the camera

HD inline uint32_t eye_group(uint32_t depth, WalkGroup of) { return kCameraGroups + depth * kWalkGroups + of; }
HD inline uint32_t particle_group(uint32_t depth, WalkGroup of) { return kGroupLight + 1 + depth * kWalkGroups + of; }
/// The group whose last pair draws the light of the eye's vertex.
HD inline uint32_t light_group(uint32_t depth) {
    return depth == 0 ? uint32_t(kGroupCamera) : eye_group(depth - 1, kWalkScatter);
}

/// Whose coins blended surfaces toss: of one walk, number by number, each its own.
inline constexpr uint32_t kEyeCoins = 0, kParticleCoins = 0x9e3779b9u, kConnectionCoins = 0x7f4a7c15u;

} // namespace pertev

#pragma once

// Gathers a scene's lights and the table that draws them by power. Powers, in W: a triangle 2 pi area mean emission;
// a point light 4 pi intensity; a spot what its cone lets through; a directional light pi R^2 irradiance and the
// environment 4 pi^2 R^2 mean radiance, R the radius of the scene. R says little about what matters inside a house, so
// where there are both near and far lights, each kind together gets at least a quarter of the draws.

#include <cstdint>
#include <vector>

#include "base/messages.h"
#include "scene/scene.h"
#include "shading/light_set.h"

namespace pertev {

struct LightSetData {
    std::vector<AliasEntry> choice; // none: nothing gives light
    std::vector<EmissiveTriangle> triangles;
    std::vector<PunctualLight> punctual;
    std::vector<uint32_t> first_light;
    std::vector<SurfaceEmission> emissions;
    EnvironmentData environment; // meaningful where has_environment
    bool has_environment = false;

    std::size_t count() const {
        return choice.empty() ? 0 : triangles.size() + punctual.size() + (has_environment ? 1 : 0);
    }
};

/// `scene` has passed validate(). `linear_from_srgb` [256]. `centre`: the origin of the world that the lights are
/// placed in, in the scene's coordinates. Throws Error(OverLimit) for more than kMaxLights.
LightSetData build_light_set(const Scene& scene, const float* linear_from_srgb, Messages& messages,
                             Vec3 centre = {0, 0, 0});

/// Triangles that give light, each placed one a light of its own.
uint64_t count_emissive_triangles(const Scene& scene);

/// View of host memory; valid as long as the data, the images and the table are.
LightSetView view_of(const LightSetData& data, const TextureImageView* images, const float* linear_from_srgb);

} // namespace pertev

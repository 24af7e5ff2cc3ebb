#pragma once

// Gathers a scene's lights and the table that draws them by power. Powers, in W: a triangle pi area mean emission,
// twice that where both of its faces emit; a point light 4 pi intensity; a spot what its cone lets through; a
// directional light pi R^2 irradiance and the environment 4 pi^2 R^2 mean radiance, R the radius of the scene. R says
// little about what matters inside a house, so where there are both near and far lights, how they share the draws is
// said apart (render/balance_lights.h).

#include <cstdint>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "base/messages.h"
#include "scene/scene.h"
#include "shading/light_set.h"

namespace pertev {

class BrightnessPyramid;

struct LightSetData {
    OrderedTable choice; // over sources; empty: nothing gives light
    std::vector<Emitter> emitters;
    std::vector<EmissiveTriangle> triangles;
    std::vector<uint32_t> triangle_order, triangle_starts, triangle_guides;
    std::vector<PunctualLight> punctual;
    std::vector<uint32_t> first_light;
    std::vector<SurfaceEmission> emissions;
    std::shared_ptr<const EnvironmentData> environment; // null: there is none
    /// Of the textures that lights emit by, each (image, encoding) once.
    std::map<std::pair<int32_t, bool>, std::shared_ptr<const BrightnessPyramid>> pyramids;
    std::vector<double> source_powers; // W; emitters, point and spot lights, then the far ones
    uint32_t near_count = 0;           // of the sources

    /// Light from near and from far, some of each.
    bool has_both_kinds() const;
    std::size_t count() const {
        return choice.starts.empty() ? 0 : triangles.size() + punctual.size() + (environment != nullptr ? 1 : 0);
    }
};

/// What far lights get of the draws before anybody has looked at what arrives; near ones get as much.
inline constexpr double kEvenShare = 0.5;

/// `scene` has passed validate(). `linear_from_srgb` [256]. `centre`: the origin of the world that the lights are
/// placed in, in the scene's coordinates. `before`: the lights of this scene before something in it moved: what is made
/// of images is taken from there. Throws Error(OverLimit) for more than kMaxLights.
LightSetData build_light_set(const Scene& scene, const float* linear_from_srgb, Messages& messages,
                             Vec3 centre = {0, 0, 0}, const LightSetData* before = nullptr);

/// Makes the table that draws a source: by power within near and far ones, `far_share` (0, 1) of the draws for the far
/// ones where there are both.
void share_draws(LightSetData& data, double far_share);

/// Triangles that give light, each placed one a light of its own.
uint64_t count_emissive_triangles(const Scene& scene);

/// View of host memory; valid as long as the data, the images and the table are.
LightSetView view_of(const LightSetData& data, const TextureImageView* images, const float* linear_from_srgb);

} // namespace pertev

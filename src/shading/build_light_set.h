#pragma once

// Collects a scene's lights and builds the table that samples them by power. Powers, in W: for a triangle pi area
// mean emission, twice that if both of its faces emit; for a point light 4 pi intensity; for a spot the part in its
// cone; for a goniometric light intensity times the integral of its table; for a directional light pi R^2 irradiance,
// and for the environment 4 pi^2 R^2 mean radiance, with the radius R of the scene. R says little about the light
// inside a house, so if there are both near and far lights, their shares of the samples are set separately
// (render/balance_lights.h).

#include <cstdint>
#include <memory>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"
#include "shading/light_set.h"
#include "shading/light_tree/build_light_tree.h"

namespace pertev {

struct LightSetData {
    GuidedCdf choice; // over sources; empty if there is no light
    std::vector<Emitter> emitters;
    std::vector<EmissiveTriangle> triangles;
    std::vector<uint32_t> triangle_order, triangle_starts, triangle_guides;
    std::vector<PunctualLight> punctual;
    GoniometricTables goniometric;
    std::shared_ptr<const RequestedLightTree> tree; // nodes of LightSetView::tree; null before build_light_set
    std::vector<uint32_t> first_light;
    std::vector<SurfaceEmission> emissions;
    std::shared_ptr<const EnvironmentData> environment; // null if there is none
    std::vector<double> source_powers;                  // W; emitters, point and spot lights, then the far ones
    uint32_t near_count = 0;                            // number of near sources

    /// Returns whether there are both near and far lights.
    bool has_both_kinds() const;
    std::size_t count() const {
        return choice.starts.empty() ? 0 : triangles.size() + punctual.size() + (environment ? 1 : 0);
    }
};

/// Mean of the channels, the brightness by which lights are weighed.
inline double mean_of_channels(Rgb c) {
    return (static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b)) / 3.0;
}

/// Initial share of far lights in the samples, before balance_lights; near lights get the rest.
inline constexpr double kEvenShare = 0.5;

/// Builds the lights of a `scene` that has passed validate(). `linear_from_srgb` [256]. `centre` is the origin of the
/// world in which the lights are placed, in the scene's coordinates. `environment` is the data of this scene's
/// environment from an earlier call, or null. Throws Error(OverLimit) for more than kMaxLights.
LightSetData build_light_set(const Scene& scene, const float* linear_from_srgb, Sink& sink, Vec3 centre = {0, 0, 0},
                             std::shared_ptr<const EnvironmentData> environment = nullptr);

/// Builds the table that samples a source: by power within near and far ones, with `far_share`, in (0, 1), of the
/// samples for far ones if there are both.
void share_draws(LightSetData& data, double far_share);

/// Number of emissive triangles; every instance counts separately.
uint64_t count_emissive_triangles(const Scene& scene);

/// Calls `visit(array, pointer)` for each array and the pointer to it in a view. The table of sources, the light tree
/// and the environment have views of their own.
template <class Visit>
void visit_arrays(const LightSetData& data, LightSetView& view, const Visit& visit) {
    visit(data.emitters, view.emitters);
    visit(data.triangle_order, view.triangle_order);
    visit(data.triangle_starts, view.triangle_starts);
    visit(data.triangle_guides, view.triangle_guides);
    visit(data.triangles, view.triangles);
    visit(data.punctual, view.punctual);
    visit(data.goniometric.tables, view.goniometric.tables);
    visit(data.goniometric.values, view.goniometric.values);
    visit(data.goniometric.starts, view.goniometric.starts);
    visit(data.goniometric.guides, view.goniometric.guides);
    visit(data.first_light, view.first_light);
    visit(data.emissions, view.emissions);
}

/// View of host memory, valid as long as the data, the images and the table. The light tree has only its number of
/// lights until it is requested.
LightSetView view_of(const LightSetData& data, const TextureImageView* images, const float* linear_from_srgb);

} // namespace pertev

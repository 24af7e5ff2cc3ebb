#pragma once

// A vertex of a path whose light goes to layers of light-path expressions too: shade_hit, and what the automaton makes
// of it. And a vertex of paths whose first surface is a light meter. The same function on both devices.

#include "integrators/path/shade_hit.h"
#include "render/light_paths/light_path_view.h"

namespace pertev {

/// What a shadow ray brings, for layers.
struct LayerShadow {
    Rgb diffuse;          // of its contribution, what goes through diffuse lobes of the vertex
    LightPathState state; // of the path before the vertex
    uint32_t column = 0;  // of the vertex' scatterings to that side
    uint32_t light = 0;   // LightPathView::light_of
};

/// A shadow ray of `contribution` that met nothing.
HD inline void add_to_layers(const LightPathView& layers, const FilmView& film, uint32_t pixel,
                             const LayerShadow& shadow, Rgb contribution) {
    const auto after = [&](LobeClass lobe_class) {
        return layers.after(shadow.state, shadow.column + scattering_column(lobe_class, false));
    };
    layers.add(film, pixel, after(LobeClass::Diffuse), shadow.light, shadow.diffuse);
    layers.add(film, pixel, after(LobeClass::Glossy), shadow.light, contribution - shadow.diffuse);
}

/// As shade_hit (`kMotion` and `numbers` too). `state`: of the path before the vertex, then after it. `parts` is
/// written where `wants_shadow` is. `is_meter`: the picture is that of the irradiance of what the camera sees, W/m2,
/// black where it sees no surface.
template <MotionKnown kMotion, class Numbers>
HD INLINE_ON_DEVICE bool
shade_hit_to_layers(const PictureView& picture, const PathSettings& settings, const FilmView& film,
                    const LightPathView& layers, bool is_meter, LightPathState& state, PathState& path, const Hit& hit,
                    const Numbers& numbers, ShadowRay& shadow, bool& wants_shadow, LayerShadow& parts) {
    const LightSetView& lights = picture.scene.lights;
    const Rgb before = path.radiance; // taken out, so that what the vertex adds is known to the last bit
    path.radiance = {0, 0, 0};
    VertexEvents events;
    events.is_meter = is_meter;
    const bool is_sky_seen = hit.instance == kNoHit && path.depth == 0;
    const bool goes_on = shade_hit<MaterialsKnown::Nothing, false, false, kMotion>(
        picture, settings, film, path, hit, numbers, shadow, wants_shadow, events);
    if (is_meter && is_sky_seen) path.radiance = {0, 0, 0};
    if (!layers.is_there()) {
        path.radiance = before + path.radiance;
        return goes_on;
    }
    const bool is_hit = hit.instance != kNoHit;
    const TriangleId emitter = is_hit ? TriangleId{hit.instance, hit.primitive} : TriangleId{kNoLight, kNoLight};
    if (!is_black(path.radiance)) layers.add(film, path.pixel, state, layers.light_of(lights, emitter), path.radiance);
    path.radiance = before + path.radiance;
    if (!is_hit) return goes_on;
    const uint32_t column = layers.first_column(hit.instance);
    if (wants_shadow) {
        parts.diffuse = events.light_diffuse * shadow.contribution;
        parts.state = state;
        parts.column = column + scattering_column(LobeClass::Diffuse, events.light_is_transmission);
        parts.light = layers.light_of(lights, shadow.target);
    }
    if (goes_on) {
        const SampleKey key = sample_key(settings, path.pixel, path.sample);
        const uint32_t group = vertex_group(path.depth - 1, kGroupChoices); // of the vertex left behind
        const float u = events.is_specular ? 0.5f : sample_1d(settings.sampler, key, group, kNumberLightPath);
        state = after_scattering(layers, state, column, events.is_specular, events.is_transmission, events.diffuse, u);
    }
    return goes_on;
}

} // namespace pertev

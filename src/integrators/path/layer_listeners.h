#pragma once

// Listeners for layers of light-path expressions, and for pictures of irradiance, which place a light meter on the
// first surface of each path.

#include "device_scene/thin_walls.h"
#include "integrators/path/film_listener.h"
#include "integrators/path/medium.h"

namespace pertev {

/// Share of diffuse lobes, [0, 1] per colour, in the light that the surface scatters from wi to wo by non-delta
/// lobes; glossy lobes have the rest. Returns `if_dark` if it scatters nothing.
HD_CALL inline Rgb exact_diffuse_share(const Surface& surface, Vec3 wo, Vec3 wi, float if_dark) {
    if (!surface.bsdf.has(LobeClass::Glossy)) return grey(1.0f);
    if (!surface.bsdf.has(LobeClass::Diffuse)) return grey(0.0f);
    const Rgb all = surface.evaluate(wo, wi).f, f = surface.evaluate(wo, wi, only(LobeClass::Diffuse)).f;
    return {all.r > 0 ? min(f.r / all.r, 1.0f) : if_dark, all.g > 0 ? min(f.g / all.g, 1.0f) : if_dark,
            all.b > 0 ? min(f.b / all.b, 1.0f) : if_dark};
}

/// Turns the first surface into a light meter, which sends its irradiance to the camera and nothing else. The picture
/// is black where the camera sees no surface.
class IrradianceMeter : public PathListener<IrradianceMeter> {
public:
    HD explicit IrradianceMeter(const PathJob& job) : is_there_(job.is_meter) {}

    HD void vertex(const PathState& path, const Hit&, Surface& surface) {
        if (!is_there_ || path.depth != 0) return;
        surface.bsdf = Bsdf(DiffuseLobe{grey(kPi), 1}); // a white diffuse surface would have the radiance E / pi
        surface.emission = {};
        surface.is_unlit = false;
    }
    HD bool removes_emission(const PathState& path, const EmitterPoint&, float) { return is_there_ && path.depth == 0; }

private:
    bool is_there_;
};

/// Adds light to the layers that the automaton selects (render/light_paths/light_path_view.h).
class LightPaths : public PathListener<LightPaths> {
public:
    struct PathData {
        LightPathState state; // state before the next vertex
    };
    /// States where a shadow ray ends, for light that lobes of either class have scattered at the vertex.
    struct StatesAtLight {
        LightPathState by_diffuse, by_glossy;
    };
    struct ShadowData {
        Rgb diffuse; // part of the contribution that passes through diffuse lobes of the vertex
        uint32_t pixel;
        StatesAtLight states;
        uint32_t light; // result of LightPathView::light_of
    };

    HD explicit LightPaths(const PathJob& job) : job_(job) {}

    HD void begins(const PathState&) { state_ = layers().begin(); }
    HD void restore(const PathData& kept) { state_ = kept.state; }
    HD void missed(const PathState&) { hit_ = {kNoLight, kNoLight}; }
    HD void vertex(const PathState&, const Hit& hit, Surface&) { hit_ = {hit.instance, hit.primitive}; }
    HD void emitted(const PathState& path, Rgb light) {
        if (!layers().is_there() || is_black(light)) return;
        layers().add(job_.film, path.pixel, state_, layers().light_of(lights(), hit_), light);
    }
    HD INLINE_ON_DEVICE void direct(const PathState& path, const SurfaceVertex& at, Vec3 wi, const ShadowRay& shadow) {
        if (!layers().is_there()) return;
        const bool is_transmission = !at.surface.same_side(at.wo, wi);
        keep_shadow(path, hit_.instance, is_transmission, shadow,
                    exact_diffuse_share(at.surface, at.wo, wi, 0) * shadow.contribution);
    }
    HD INLINE_ON_DEVICE void scattered(const PathState& path, const SurfaceVertex& at, const BsdfSample& sample) {
        if (!layers().is_there()) return;
        const bool is_specular = sample.is_delta();
        Rgb diffuse;
        float u = 0.5f;
        if (!is_specular) {
            const float if_dark = sample.lobe_class == LobeClass::Diffuse ? 1.0f : 0.0f;
            diffuse = exact_diffuse_share(at.surface, at.wo, sample.wi, if_dark);
            const SampleKey key = sample_key(job_.settings, path.pixel, path.sample);
            const uint32_t group = vertex_group(path.depth - 1, kGroupChoices); // group of the previous vertex
            u = sample_1d(job_.settings.sampler, key, group, kNumberLightPath);
        }
        state_ = after_scattering(layers(), state_, layers().first_column(hit_.instance), is_specular,
                                  sample.is_transmission, diffuse, u);
    }
    /// A medium's scattering is diffuse, at the body that it fills.
    HD void direct(const PathState& path, const MediumVertex& at, Vec3, const ShadowRay& shadow) {
        if (!layers().is_there()) return;
        keep_shadow(path, at.instance, false, shadow, shadow.contribution);
    }
    HD void scattered(const PathState&, const MediumVertex& at, const BsdfSample&) {
        if (!layers().is_there()) return;
        state_ = after_scattering(layers(), state_, layers().first_column(at.instance), false, false, grey(1), 0.5f);
    }
    HD void save(PathData& kept) const { kept = {state_}; }
    HD void save_shadow_data(ShadowData& shadow_data) const { shadow_data = shadow_data_; }

    HD void arrived(PathData&, const ShadowData& shadow_data, Rgb contribution) const {
        if (!layers().is_there()) return;
        layers().add(job_.film, shadow_data.pixel, shadow_data.states.by_diffuse, shadow_data.light,
                     shadow_data.diffuse);
        layers().add(job_.film, shadow_data.pixel, shadow_data.states.by_glossy, shadow_data.light,
                     contribution - shadow_data.diffuse);
    }

    HD static void load(const ListenerQueues& queues, uint32_t i, PathData& kept) {
        if (queues.states != nullptr) kept.state = {queues.states[i].x, queues.states[i].y};
    }
    HD static void load_next(const ListenerQueues& queues, uint32_t i, PathData& kept) {
        if (queues.next_states != nullptr) kept.state = {queues.next_states[i].x, queues.next_states[i].y};
    }
    HD static void store_next(const ListenerQueues& queues, uint32_t i, const PathData& kept) {
        if (queues.next_states != nullptr) queues.next_states[i] = {kept.state.red_green, kept.state.blue};
    }
    HD static void load_shadow_data(const ListenerQueues& queues, uint32_t i, ShadowData& shadow_data) {
        if (queues.layer_parts == nullptr) return;
        const Float4 d = queues.layer_diffuse[i];
        const Uint4 p = queues.layer_parts[i];
        shadow_data = {{d.x, d.y, d.z}, bits_of(d.w), {{p.x, p.z & 0xffffu}, {p.y, p.z >> 16}}, p.w};
    }
    HD static void store_shadow_data(const ListenerQueues& queues, uint32_t i, const ShadowData& shadow_data) {
        if (queues.layer_parts == nullptr) return;
        queues.layer_diffuse[i] = {shadow_data.diffuse.r, shadow_data.diffuse.g, shadow_data.diffuse.b,
                                   float_of(shadow_data.pixel)};
        const LightPathState &d = shadow_data.states.by_diffuse, &g = shadow_data.states.by_glossy;
        queues.layer_parts[i] = {d.red_green, g.red_green, d.blue | g.blue << 16, shadow_data.light};
    }

private:
    /// Keeps what is known of a shadow ray from a vertex on `instance`; diffuse lobes have the part `diffuse` of its
    /// contribution.
    HD INLINE_ON_DEVICE void keep_shadow(const PathState& path, uint32_t instance, bool is_transmission,
                                         const ShadowRay& shadow, Rgb diffuse) {
        const uint32_t column = layers().first_column(instance);
        const auto after = [&](LobeClass lobe_class) {
            return layers().after(state_, column + scattering_column(lobe_class, is_transmission));
        };
        StatesAtLight states = {after(LobeClass::Diffuse), after(LobeClass::Glossy)};
        if (job_.passes_thin_walls) {
            const Ray ray = {shadow.origin, 0.0f, shadow.direction, shadow.t_max};
            states = after_thin_walls(job_.picture.scene, layers(), states, ray);
        }
        shadow_data_ = {diffuse, path.pixel, states, layers().light_of(lights(), shadow.target)};
    }
    /// Each thin wall on a shadow ray scatters its light as a lobe without extent.
    HD_CALL static StatesAtLight after_thin_walls(const SceneView& scene, const LightPathView& layers,
                                                  StatesAtLight states, Ray ray) {
        visit_thin_walls(scene, ray.origin, ray.direction, ray.t_max, [&](const SurfaceCrossing& crossing) {
            const uint32_t column =
                layers.first_column(crossing.instance) + scattering_column(LobeClass::Specular, true);
            states = {layers.after(states.by_diffuse, column), layers.after(states.by_glossy, column)};
            return false;
        });
        return states;
    }
    HD const LightPathView& layers() const { return job_.layers; }
    HD const LightSetView& lights() const { return job_.picture.scene.lights; }

    const PathJob& job_;
    LightPathState state_;
    TriangleId hit_; // hit of the path's ray
    ShadowData shadow_data_ = {};
};

using LayerListeners = Listeners<IrradianceMeter, FirstHitLayers, LightPaths>;

} // namespace pertev

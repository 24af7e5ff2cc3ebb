#pragma once

// Stages of the paths of irradiance caching: camera paths, and the rays of records. Both are path tracing. But where
// a camera path that has only passed mirrors and smooth glass reaches a surface with a diffuse base, its light is
//   L S* D                  sampled by a shadow ray and by the path's own next ray, as in path tracing;
//   L S+ (D|G) (D|G|S)* D   found by the path, which continues only for it if the scene has mirrors or smooth glass;
//   L (D|G) (D|G|S)* D      looked up, because a record's rays find it. Without a record, the path continues normally.
// Light that other lobes there scatter is found by the same next ray.
//
// Source: Ward, Rubinstein, Clear, "A Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988, section 2.

#include "integrators/irradiance_cache/cache_memory.h"
#include "integrators/irradiance_cache/irradiance_record.h"
#include "integrators/subpaths/particle_stages.h"
#include "shading/may_be_specular.h"
#include "shading/power_heuristic.h"

namespace pertev {

inline constexpr uint32_t kNumberOfOthers = 2; // index among a vertex's choices: whether the path continues for other
                                               // lobes

/// The stage that counts the emitters and mirrors of instance i.
struct CountMirroredEmitters {
    SceneView scene;
    MirroredEmitters* count;

    HD void operator()(uint32_t i) const {
        const InstanceView& instance = scene.instances[i];
        if (instance.is_hidden != 0) return;
        const MaterialParameters& material = scene.materials[instance.material];
        const bool glows = material.is_unlit() || !is_black(material.emission);
        if (may_be_specular(material)) atomic_add(&count->mirrors, 1);
        if (glows || scene.lights.has_environment()) atomic_add(&count->emitters, 1);
    }
};

/// The stage that starts camera paths 0, 1, ... of the samples.
struct BeginCacheSubpaths {
    BeginCameraSubpaths begin;
    CacheSubpathsView cache;

    HD void operator()(uint32_t i) const {
        begin(i);
        cache.store_cache_state(i, {{1, 1, 1}, 0});
        cache.store_path(i, {1, 1, 1});
        cache.distances[i] = 0;
        cache.aims[i] = SubpathAim::Seek;
    }
};

/// The stage that shades the hits of paths. `Choice` selects lights (shading/light_set.h).
template <ShadingVariant kVariant, class Choice = ChosenByPower>
struct ShadeCacheSubpaths {
    SubpathScene scene;
    SubpathsView subpaths;
    CacheSubpathsView cache;
    FilmView film; // for pixels or for cells of hemispheres; without sums nothing is added
    const MirroredEmitters* mirrored;
    bool is_hemisphere; // path i adds light to cell first_cell + i
    uint32_t first_cell;
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const uint32_t subpath = subpaths.owners[round % 2][i];
        if (cache.aims[subpath] == SubpathAim::End) return;
        const PictureView& picture = scene.picture;
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        const Hit hit = subpaths.hits().load(i);
        SubpathState state = subpaths.states[subpath];
        CacheState cache_state = cache.cache_state_of(subpath);
        if (hit.instance == kNoHit) return add_background(subpath, state, cache_state, ray);
        const Surface surface = make_surface<kVariant>(picture.scene, hit, ray.direction);
        Rgb path = cache.path_of(subpath);
        arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput, cache_state.seen, path);
        if (kVariant == ShadingVariant::General) cache.store_path(subpath, path);
        if (adds_light() && state.depth() == 0) {
            add_seen(picture, film, state, ray, hit, surface);
        } else if (adds_light() && !is_black(surface.emission)) {
            const uint32_t light =
                cache_state.pdf > 0 ? light_of(picture.scene.lights, hit.instance, hit.primitive) : kNoLight;
            add_light(subpath, state, cache_state, surface.emission,
                      light != kNoLight ? pdf_of_hit(light, subpath, ray.origin, surface.position) : 0.0f);
        }
        const uint32_t depth = state.depth();
        if (surface.is_unlit || depth >= scene.settings.max_depth) return;
        const float distance = cache.distances[subpath] + hit.t;
        const Vec3 wo = -ray.direction;
        const bool is_cached = cache.aims[subpath] == SubpathAim::Seek && depth + 2 <= scene.settings.max_depth &&
                               CachedSurface(surface, wo).is_cached;
        const Vertex vertex = {surface, wo, is_cached, {state.pixel, state.sample, scene.settings.seed}};
        if (is_cached) {
            cache.store(atomic_add(&subpaths.counts->vertices, 1u),
                        {hit, ray.direction, distance, state.throughput, subpath, depth});
        }
        if (adds_light()) sample_direct_light(vertex, subpath, state);
        cache.distances[subpath] = distance;
        continue_subpath(vertex, subpath, state, cache_state);
    }

private:
    struct Vertex {
        const Surface& surface;
        Vec3 wo;
        bool is_cached; // light is looked up
        SampleKey key;
    };

    /// Returns the density with which a shadow ray would have been sampled to the point of a light that the path hit.
    HD float pdf_of_hit(uint32_t light, uint32_t subpath, Vec3 from, Vec3 point) const {
        const LightContext before = light_context_before<Choice>(subpaths, subpath, from);
        return pdf_light_hit<Choice>(scene.picture.scene.lights, light, before, point);
    }
    HD bool adds_light() const { return film.sums != nullptr; }
    HD uint32_t film_index(uint32_t subpath, const SubpathState& state) const {
        return is_hemisphere ? first_cell + subpath : state.pixel;
    }

    /// Adds light that the path hit. `light_pdf` is the density with which a shadow ray would have been sampled
    /// there.
    HD void add_light(uint32_t subpath, const SubpathState& state, const CacheState& cache_state, Rgb emission,
                      float light_pdf) const {
        if (is_black(cache_state.seen)) return;
        const float weight = light_pdf > 0 ? power_heuristic(cache_state.pdf, light_pdf) : 1.0f;
        add_radiance(film, film_index(subpath, state), (weight * cache_state.seen) * emission);
    }
    HD void add_background(uint32_t subpath, const SubpathState& state, const CacheState& cache_state,
                           const Ray& ray) const {
        if (!adds_light()) return;
        if (state.depth() == 0) return add_seen_background(scene.picture, film, state, ray);
        const LightSetView& lights = scene.picture.scene.lights;
        if (!lights.has_environment()) return;
        add_light(subpath, state, cache_state, environment_radiance(lights.environment, ray.direction),
                  cache_state.pdf > 0 ? pdf_environment(lights, ray.origin, ray.direction) : 0.0f);
    }

    /// Samples one point of one light, as path tracing does.
    HD INLINE_ON_DEVICE void sample_direct_light(const Vertex& vertex, uint32_t subpath,
                                                 const SubpathState& state) const {
        const SceneView& view = scene.picture.scene;
        const Surface& surface = vertex.surface;
        if (surface.bsdf.has_delta_only() || is_black(state.throughput)) return;
        LightSample light;
        const SampleBits bits = sample_bits(scene.settings.sampler, vertex.key, light_group(state.depth()), Pair::Last);
        const LightContext context = surface.light_context(vertex.wo);
        if (!sample_light<emitter_variant(kVariant), Choice>(view.lights, context, bits, light)) return;
        const BsdfValue scattered = evaluate_surface<kVariant>(surface, vertex.wo, light.wi);
        if (is_black(scattered.f)) return;
        const uint32_t coin = coin_key(vertex.key, state.depth(), true);
        if (is_hole(view, light, coin)) return;
        const float weight = light.is_delta ? 1.0f : power_heuristic(light.pdf, scattered.pdf);
        Connection connection;
        connection.ray = ray_to_light(light, surface.position, surface.error, surface.geometric_normal);
        connection.start = surface.triangle;
        connection.target = triangle_of(light);
        connection.key = coin;
        if constexpr (kVariant == ShadingVariant::General) {
            light.radiance = light.radiance * transmittance_to_light<kVariant>(view, surface.triangle, light);
        }
        connection.light = (weight / light.pdf) * (state.throughput * scattered.f * light.radiance);
        subpaths.queue_connection(atomic_add(&subpaths.counts->connections, 1u), connection,
                                  film_index(subpath, state));
    }

    HD INLINE_ON_DEVICE void continue_subpath(const Vertex& vertex, uint32_t subpath, SubpathState& state,
                                              CacheState cache_state) const {
        const Surface& surface = vertex.surface;
        const SubpathSettings& settings = scene.settings;
        const uint32_t choices = camera_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw =
            draw_scatter(settings, vertex.key, surface.bsdf, camera_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = sample_surface<kVariant>(surface, vertex.wo, draw.lobe, draw.u);
        if (!(sample.pdf > 0)) return;
        Rgb path_weight = sample.weight;
        if (!sample.is_delta() && vertex.is_cached) path_weight = others_share(vertex, sample, choices);
        const Rgb before = sample.weight;
        if (!survives(settings, vertex.key, choices, state.depth() + 1, sample)) return;
        const float made_up = max_component(before) > 0 ? max_component(sample.weight) / max_component(before) : 0.0f;
        // Records do not contain reflections of emitters in mirrors and smooth glass, so those count fully for the
        // path.
        const Rgb path = cache.path_of(subpath) * sample.weight;
        cache_state =
            sample.is_delta() ? CacheState{path, 0} : CacheState{state.throughput * sample.weight, sample.pdf};
        state.throughput = made_up * (state.throughput * path_weight);
        const bool counts = !is_black(cache_state.seen) || !is_black(state.throughput);
        if (!counts && (is_black(path) || !mirrored->are_possible())) return;
        cache.store_path(subpath, path);
        ++state.scatterings;
        subpaths.states[subpath] = state;
        cache.store_cache_state(subpath, cache_state);
        store_light_normal<Choice>(subpaths, subpath, SurfaceEnd<kVariant>{surface}, vertex.wo);
        if (!sample.is_delta()) cache.aims[subpath] = SubpathAim::GoOn;
        if (!sample.is_delta() && !adds_light()) return; // nothing more can contribute
        const Vec3 wi = sample.wi;
        const Ray ray = {offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi), 0, wi,
                         kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, surface.triangle,
                           coin_key(vertex.key, state.depth(), false), round + 1);
    }

    /// Part of the weight that lobes other than the diffuse base scatter. If it is small, few paths continue for it.
    HD Rgb others_share(const Vertex& vertex, const BsdfSample& sample, uint32_t choices) const {
        if (vertex.surface.bsdf.layer_count == 0) return {0, 0, 0};
        const Rgb f = evaluate_surface<kVariant>(vertex.surface, vertex.wo, sample.wi, only(LobeClass::Glossy)).f;
        const Rgb weight_sum = (1.0f / sample.pdf) * f;
        const float chance = max_component(weight_sum) / max_component(sample.weight);
        if (!(chance < 1)) return weight_sum;
        const float u = sample_1d(scene.settings.sampler, vertex.key, choices, kNumberOfOthers);
        return u < chance ? (1.0f / chance) * weight_sum : Rgb{0, 0, 0};
    }
};

} // namespace pertev

#pragma once

// Stages of light subpaths in order: begin; then, round by round, shade the hits, add the connections that the camera
// sees, and count. They are launched one by one on a device; a CPU thread runs the same ones over a few subpaths of
// its own.
//
// Source: Dutre, Lafortune, Willems, "Monte Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993.

#include "device/atomics.h"
#include "integrators/subpaths/emit_particle.h"
#include "integrators/subpaths/selection_ratio.h"
#include "integrators/subpaths/subpath_media.h"
#include "render/begin_order.h"
#include "render/connect_to_camera.h"
#include "render/film_view.h"
#include "render/first_hit.h"
#include "render/pixel_filter.h"

namespace pertev {

// Splats of particles. Camera rays of a pixel are sampled from the pixel filter around its centre
// (render/pixel_filter.h), so the pixel's value is a mean over the filter's density. Therefore a particle's light at
// a picture position counts for each pixel around it times that density, in 1/pixel^2. Sums are integers, thus
// independent of their order.

/// Density, 1/pixel, with which sample_filter_axis returns `x`, in pixels from the pixel's centre.
HD inline float filter_density(const PixelFilterView& filter, float x) {
    const float at = x / filter.radius;
    if (!(abs(at) < 1)) return 0;
    switch (filter.kind) {
    case PixelFilter::Box:
        return 0.5f / filter.radius;
    case PixelFilter::Tent:
        return pdf_tent(at) / filter.radius;
    case PixelFilter::Gaussian:
    case PixelFilter::BlackmanHarris:
        break;
    }
    int low = 0, high = kFilterTableSize; // table[low] <= at < table[high]
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (filter.table[middle] <= at ? low : high) = middle;
    }
    const float width = filter.table[high] - filter.table[low];
    if (!(width > 0)) return 0;
    const float part = 1.0f / static_cast<float>(kFilterTableSize);
    const float u = (static_cast<float>(low) + (at - filter.table[low]) / width) * part;
    return pdf_tent(2.0f * u - 1.0f) * (2.0f * part) / (width * filter.radius);
}

/// Adds `light` at `raster`, in pixels from the picture's upper left corner, as far as the film holds it.
HD inline void add_splat(const FilmView& film, const PixelFilterView& filter, Vec2 raster, Rgb light) {
    constexpr int kFar = 1 << 30;
    const float left = raster.x - 0.5f - filter.radius, top = raster.y - 0.5f - filter.radius;
    const PixelWindow& window = film.window;
    const int first_x = to_int(floor(left) + 1.0f, static_cast<int>(window.x), kFar);
    const int first_y = to_int(floor(top) + 1.0f, static_cast<int>(window.y), kFar);
    const int last_x = to_int(raster.x - 0.5f + filter.radius, 0, static_cast<int>(window.x + window.width) - 1);
    const int last_y = to_int(raster.y - 0.5f + filter.radius, 0, static_cast<int>(window.y + window.height) - 1);
    for (int y = first_y; y <= last_y; ++y) {
        const float row = filter_density(filter, raster.y - 0.5f - static_cast<float>(y));
        if (!(row > 0)) continue;
        for (int x = first_x; x <= last_x; ++x) {
            const float share = row * filter_density(filter, raster.x - 0.5f - static_cast<float>(x));
            if (!(share > 0)) continue;
            add_radiance(film, window.pixel_in(static_cast<uint32_t>(x), static_cast<uint32_t>(y)), share * light);
        }
    }
}

/// Initial state of a subpath for the sample `number`.
HD inline SubpathState state_of_sample(const BeginOrder& samples, uint64_t number) {
    const PixelSample begun = samples.at(number);
    SubpathState state = {};
    state.pixel = begun.pixel, state.sample = begun.sample;
    return state;
}

/// Key of a particle's random numbers. If there are only particles, one sequence covers the particles of the whole
/// picture, so that all of them together are evenly distributed. If they connect to the camera subpath of their
/// pixel, each pixel has its own sequence.
HD inline SampleKey particle_sample_key(const SubpathScene& scene, uint32_t pixel, uint32_t sample) {
    if (scene.is_connected) return {pixel, sample, scene.settings.seed};
    const CameraRays& camera = scene.picture.camera;
    const uint64_t number = uint64_t(sample) * (uint64_t(camera.width) * camera.height) + pixel;
    return {static_cast<uint32_t>(number >> 32), static_cast<uint32_t>(number), scene.settings.seed};
}

/// The stage that starts the particles of samples `first`, first + 1, ... of `samples` as subpaths 0, 1, ...
struct BeginParticles {
    SubpathScene scene;
    SubpathsView subpaths;
    BeginOrder samples;
    uint64_t first;

    HD void operator()(uint32_t i) const {
        const SubpathSettings& settings = scene.settings;
        SubpathState state = state_of_sample(samples, first + i);
        if (subpaths.capacity.kept > 0) subpaths.kept_counts[i] = 0;
        const SampleKey key = particle_sample_key(scene, state.pixel, state.sample);
        const SampleBits bits = sample_bits(settings.sampler, key, kGroupLight);
        const Vec2 direction = sample_2d(settings.sampler, key, kGroupLight, Pair::Last);
        const uint32_t coin = coin_key({state.pixel, state.sample, settings.seed ^ kParticleCoins}, 0, false);
        Particle particle;
        if (!emit_particle(scene.picture.scene, scene.world, bits, direction, coin, particle)) return;
        if (scene.picture.scene.has_media != 0) begin_in_media(scene.picture.scene, subpaths, i, particle);
        if (!(max_component(particle.power) > 0)) return;
        state.throughput = particle.power;
        state.mis = particle.mis;
        state.is_from_far = particle.is_from_far ? 1 : 0;
        subpaths.states[i] = state;
        subpaths.squared_indices[i] = 1;
        if (subpaths.lights != nullptr) subpaths.lights[i] = particle.light;
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), i, particle.ray, particle.start, coin, 0);
    }
};

/// The stage that shades hits of particles, and scatterings in media: a connection to the camera, a stored vertex, the
/// continuation. `Choice` selects the lights of next-event estimation (shading/light_set.h).
template <ShadingVariant kVariant, bool kInMedia = false, class Choice = ChosenByPower>
struct ShadeParticles {
    SubpathScene scene;
    SubpathsView subpaths;
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const Hit hit = subpaths.hits().load(i);
        if (!kInMedia && hit.instance == kNoHit) return;
        const uint32_t subpath = subpaths.owners[round % 2][i];
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        SubpathState state = subpaths.states[subpath];
        if constexpr (kInMedia) {
            shade_in_media(i, hit, subpath, ray, state);
        } else {
            const Surface surface = make_surface<kVariant>(scene.picture.scene, hit, ray.direction);
            if (state.depth() == 0) state.throughput = left_at(hit.t, ray.t_max) * state.throughput;
            arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput);
            if (surface.is_unlit || is_black(state.throughput)) return;
            state.mis.arrive(cosine_at(surface, ray.direction), state.is_from_far != 0 ? 1.0f : square(hit.t));
            shade_vertex(SurfaceEnd<kVariant>{surface}, hit, ray.direction, subpath, state, {});
        }
    }

private:
    HD INLINE_ON_DEVICE void shade_in_media(uint32_t i, const Hit& hit, uint32_t subpath, const Ray& ray,
                                            SubpathState& state) const {
        const SceneView& view = scene.picture.scene;
        InteriorList list = subpaths.load_interior(subpath);
        const bool is_from_far = state.is_from_far != 0;
        const SubpathFlight flight = fly(scene, particle_sample_key(scene, state.pixel, state.sample),
                                         kGroupLight + state.depth(), ray, hit, is_from_far, list, state.throughput);
        if (state.depth() == 0) state.throughput = left_at(flight.distance, ray.t_max) * state.throughput;
        if (is_black(state.throughput)) return;
        const float distance_factor = (is_from_far ? 1.0f : square(flight.distance)) / flight.probability;
        if (flight.is_scattered) {
            const MediumEnd end = {flight.point, ray.direction, flight.share};
            state.mis.arrive(end.density_factor(ray.direction), distance_factor);
            return shade_vertex(end, SubpathVertex::hit_in_medium(end.position()), ray.direction, subpath, state, list);
        }
        if (hit.instance == kNoHit) return;
        Surface surface = make_surface<kVariant>(view, hit, ray.direction);
        const Rgb passed = reach_surface(view, list, subpaths.start_of(i, round), ray.direction, hit, surface);
        state.throughput = passed * state.throughput;
        if (surface.is_unlit || is_black(state.throughput)) return;
        state.mis.arrive(cosine_at(surface, ray.direction), distance_factor);
        shade_vertex(SurfaceEnd<kVariant>{surface}, hit, ray.direction, subpath, state, list);
    }
    /// Shades a vertex at which the subpath arrives along `direction`; `list` has the solids that hold it there.
    template <class End>
    HD INLINE_ON_DEVICE void shade_vertex(const End& end, const Hit& hit, Vec3 direction, uint32_t subpath,
                                          SubpathState& state, InteriorList list) const {
        state.is_from_far = 0;
        if constexpr (Choice::kReadsNormal) {
            // The first vertex scatters to the side from which the light comes, or to both.
            const LightContext context = end.light_context(-direction);
            const uint32_t light = state.depth() == 0 ? subpaths.lights[subpath] : kNoLight;
            state.mis.select_light(selection_ratio<Choice>(scene.picture.scene.lights, context, light));
        }
        const bool can_be_connected = !end.scatters_by_delta_alone();
        if (state.depth() < subpaths.capacity.kept) {
            const std::size_t at = subpaths.kept_index(subpath, state.depth());
            if (can_be_connected) {
                subpaths.kept.store(
                    at, {hit, direction, (1.0f / subpaths.squared_indices[subpath]) * state.throughput, state.mis});
                if constexpr (kInMedia) subpaths.kept.store_interior(at, list);
            } else {
                subpaths.kept.store_none(at);
            }
            subpaths.kept_counts[subpath] = state.depth() + 1;
        }
        const SampleKey key = particle_sample_key(scene, state.pixel, state.sample);
        if (can_be_connected) connect_to_lens(end, hit, subpath, state, -direction, key);
        if (state.depth() + 1 < scene.settings.max_depth) {
            continue_subpath(end, subpath, state, -direction, key, list);
        }
    }
    template <class End>
    HD INLINE_ON_DEVICE void connect_to_lens(const End& end, const Hit& hit, uint32_t subpath,
                                             const SubpathState& state, Vec3 wi, SampleKey key) const {
        const SubpathSettings& settings = scene.settings;
        const CameraRays& camera = scene.picture.camera;
        const Vec2 lens = camera.has_lens() ? sample_2d(settings.sampler, key,
                                                        particle_group(state.depth(), kSubpathScatter), Pair::Last)
                                            : Vec2{};
        CameraConnection seen;
        if (!connect_to_camera(camera, end.position(), lens, seen)) return;
        const AcceptHit accept = {scene.picture.scene, {}, {}, 0};
        if (scene.picture.scene.any_hidden_back != 0 && hit.instance != kMediumInstance &&
            AcceptCameraHit{accept, seen.direction}.hits_hidden_back(hit.instance, hit.primitive)) {
            return; // the camera sees through its back
        }
        const Vec3 wo = -seen.direction;
        const BothWays scattered = end.scatter(wo, wi);
        if (is_black(scattered.particle.f)) return;
        MediumTransmittance through_media;
        if constexpr (kInMedia) {
            through_media = transmittance_of_connection(scene.picture.scene, camera.interior, seen.from, seen.direction,
                                                        length(end.position() - seen.from), {}, end.triangle());
            if (is_black(through_media.transmittance)) return;
        }
        float weight = 1;
        if (scene.is_connected) {
            float density = seen.density * end.density_factor(wo) / seen.distance_squared;
            if constexpr (kInMedia) density *= through_media.probability;
            weight = mis_weight(squared_density(density) * state.mis.weight_sum(scattered.camera.pdf));
        }
        Connection connection;
        // The ray starts on the camera's side, because camera rays pass through hidden backs.
        connection.ray = {seen.from, 0, end.origin_towards(wo) - seen.from, 1};
        connection.start = {};
        connection.target = end.triangle();
        connection.key = coin_key({state.pixel, state.sample, settings.seed ^ kParticleCoins}, state.depth(), true);
        connection.light = (weight * seen.density / seen.distance_squared) * (scattered.particle.f * state.throughput);
        connection.light =
            (1.0f / end.squared_index_along(wi, wo, subpaths.squared_indices[subpath])) * connection.light;
        if constexpr (kInMedia) {
            connection.light = through_media.transmittance * connection.light;
        } else if constexpr (kVariant == ShadingVariant::General) {
            const Rgb passed = transmittance_of_solid(scene.picture.scene, end.triangle(), {}, wo,
                                                      length(end.position() - seen.from), kAtRest);
            connection.light = passed * connection.light;
        }
        const uint32_t slot = atomic_add(&subpaths.counts->connections, 1u);
        subpaths.queue_connection(slot, connection, state.pixel);
        subpaths.connection_rasters[slot] = seen.raster;
    }
    template <class End>
    HD INLINE_ON_DEVICE void continue_subpath(const End& end, uint32_t subpath, SubpathState& state, Vec3 wi,
                                              SampleKey key, InteriorList list) const {
        const SubpathSettings& settings = scene.settings;
        const uint32_t choices = particle_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw = end.draw(settings, key, particle_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = end.sample_particle(wi, draw);
        if (!(sample.pdf > 0) || !end.survives(settings, key, choices, state.depth() + 1, sample)) return;
        const Vec3 wo = sample.wi;
        if (scene.is_connected) {
            if (sample.is_delta()) {
                state.mis.scatter_by_delta(end.density_factor(wo));
            } else {
                state.mis.scatter(end.density_factor(wo), sample.pdf, end.scatter(wo, wi).camera.pdf);
            }
        }
        if (sample.is_transmission) {
            subpaths.squared_indices[subpath] = end.squared_index_beyond(wi, subpaths.squared_indices[subpath]);
        }
        if constexpr (kInMedia) {
            subpaths.store_interior(subpath, interior_towards(scene.picture.scene, list, end, wi, wo));
        }
        state.throughput = state.throughput * sample.weight;
        ++state.scatterings;
        subpaths.states[subpath] = state;
        const Ray ray = {end.origin_towards(wo), 0, wo, kInfinity};
        const uint32_t coin =
            coin_key({state.pixel, state.sample, settings.seed ^ kParticleCoins}, state.depth(), false);
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, end.triangle(), coin, round + 1);
    }
};

/// The stage that adds the particles that the camera sees.
struct AddSplats {
    SubpathsView subpaths; // connection_keys hold the tracer's results, kNoHit if the ray hit nothing
    PixelFilterView filter;
    FilmView film;

    HD void operator()(uint32_t i) const {
        if (subpaths.connection_keys[i] != kNoHit) return;
        const Float4 light = subpaths.connection_light[i];
        add_splat(film, filter, subpaths.connection_rasters[i], {light.x, light.y, light.z});
    }
};

/// The stage that adds other connections to their pixels.
struct AddConnections {
    SubpathsView subpaths;
    FilmView film;

    HD void operator()(uint32_t i) const {
        if (subpaths.connection_keys[i] != kNoHit) return;
        const Float4 light = subpaths.connection_light[i];
        add_radiance(film, bits_of(light.w), {light.x, light.y, light.z});
    }
};

/// The stage that counts in one thread: connections since the last count and, if `ends_round`, the rays that continue.
/// `connected` is the number of light-subpath vertices that each current vertex connects to next.
struct CountSubpaths {
    SubpathCounts* counts;
    bool ends_round;
    uint32_t connected;

    HD void operator()(uint32_t) const {
        counts->all_connections += counts->connections;
        counts->connections = 0;
        counts->pairs = counts->vertices * connected;
        if (!ends_round) return;
        counts->bounces += counts->next;
        counts->rays = counts->next;
        counts->next = counts->vertices = counts->crowded = 0;
    }
};

/// The stage that starts the first round of `rays` in one thread.
struct BeginSubpaths {
    SubpathCounts* counts;
    uint32_t rays;

    HD void operator()(uint32_t) const {
        counts->rays = rays;
        counts->next = counts->connections = counts->vertices = counts->pairs = counts->crowded = 0;
    }
};

// Camera subpaths begin like paths of path tracing, with the same random numbers, so that layers of the first surface
// are equal.

/// The stage that starts the camera subpaths of samples `first`, first + 1, ... of `samples` as subpaths 0, 1, ...
struct BeginCameraSubpaths {
    SubpathScene scene;
    SubpathsView subpaths;
    BeginOrder samples;
    uint64_t first;

    HD void operator()(uint32_t i) const {
        const CameraRays& camera = scene.picture.camera;
        SubpathState state = state_of_sample(samples, first + i);
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const Ray ray = camera.ray(state.pixel, scene.settings.sampler, key);
        state.throughput = {1, 1, 1};
        state.mis = {min(square(1.0f / camera_density(camera, ray.origin, ray.direction)), kMaxWeightSum), 0};
        state.is_from_far = falls_with_distance(camera) ? 0 : 1;
        subpaths.states[i] = state;
        subpaths.queue_ray(i, i, ray, {}, coin_key(key, 0, false), 0);
    }
};

/// Adds auxiliary channels of the first surface, and its emission, of which `passed` arrives.
HD INLINE_ON_DEVICE void add_seen(const PictureView& picture, const FilmView& film, const SubpathState& state,
                                  const Ray& ray, const Hit& hit, const Surface& surface, Rgb passed = {1, 1, 1}) {
    add_first_hit(film, state.pixel, state.sample, {ray.origin, ray.direction}, hit, surface, picture);
    if (!is_black(surface.emission)) add_radiance(film, state.pixel, passed * surface.emission);
}
/// Adds the auxiliary channels of the surface behind a medium that has scattered the camera's ray.
template <ShadingVariant kVariant>
HD INLINE_ON_DEVICE void add_behind_medium(const PictureView& picture, const FilmView& film, const SubpathState& state,
                                           const Ray& ray, const Hit& hit) {
    if (hit.instance == kNoHit) return add_no_first_hit(film, state.pixel, state.sample);
    add_first_hit(film, state.pixel, state.sample, {ray.origin, ray.direction}, hit,
                  make_surface<kVariant>(picture.scene, hit, ray.direction), picture);
}
/// Adds the background for a camera ray that hit nothing, of which `passed` arrives.
HD inline void add_seen_background(const PictureView& picture, const FilmView& film, const SubpathState& state,
                                   const Ray& ray, Rgb passed = {1, 1, 1}) {
    add_no_first_hit(film, state.pixel, state.sample);
    const LightSetView& lights = picture.scene.lights;
    if (!lights.has_environment() || picture.hides_background(ray.origin)) return;
    add_radiance(film, state.pixel, passed * environment_radiance(lights.environment, ray.direction));
}

} // namespace pertev

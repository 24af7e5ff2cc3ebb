#pragma once

// Stages of light subpaths in order: begin; then, round by round, shade the hits, add the connections that the camera
// sees, and count. They are launched one by one on a device; a CPU thread runs the same ones over a few subpaths of
// its own.
//
// Source: Dutre, Lafortune, Willems, "Monte Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993.

#include "device/atomic_add.h"
#include "integrators/subpaths/emit_particle.h"
#include "integrators/subpaths/walk_vertex.h"
#include "render/begin_order.h"
#include "render/film_view.h"
#include "render/first_hit.h"
#include "render/pixel_filter.h"
#include "render/see_vertex.h"

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

/// Adds `light` at `raster`, in pixels from the upper left corner.
HD inline void add_splat(const FilmView& film, const PixelFilterView& filter, Vec2 raster, Rgb light) {
    constexpr int kFar = 1 << 30;
    const float left = raster.x - 0.5f - filter.radius, top = raster.y - 0.5f - filter.radius;
    const int first_x = to_int(floor(left) + 1.0f, 0, kFar), first_y = to_int(floor(top) + 1.0f, 0, kFar);
    const int last_x = to_int(raster.x - 0.5f + filter.radius, 0, static_cast<int>(film.width) - 1);
    const int last_y = to_int(raster.y - 0.5f + filter.radius, 0, static_cast<int>(film.height) - 1);
    for (int y = first_y; y <= last_y; ++y) {
        const float row = filter_density(filter, raster.y - 0.5f - static_cast<float>(y));
        if (!(row > 0)) continue;
        for (int x = first_x; x <= last_x; ++x) {
            const float share = row * filter_density(filter, raster.x - 0.5f - static_cast<float>(x));
            if (!(share > 0)) continue;
            add_radiance(film, static_cast<uint32_t>(y) * film.width + static_cast<uint32_t>(x), share * light);
        }
    }
}

/// Initial state of a subpath for the sample `number`.
HD inline WalkState state_of_sample(const BeginOrder& samples, uint64_t number, const CameraRays& camera) {
    const PixelSample begun = samples.at(number, camera.width, camera.height);
    WalkState state = {};
    state.pixel = begun.pixel, state.sample = begun.sample;
    return state;
}

/// Key of a particle's random numbers. If there are only particles, one sequence covers the particles of the whole
/// picture, so that all of them together are evenly distributed. If they connect to the camera subpath of their
/// pixel, each pixel has its own sequence.
HD inline SampleKey particle_sample_key(const WalkScene& scene, uint32_t pixel, uint32_t sample) {
    if (scene.is_joined) return {pixel, sample, scene.settings.seed};
    const CameraRays& camera = scene.picture.camera;
    const uint64_t number = uint64_t(sample) * (uint64_t(camera.width) * camera.height) + pixel;
    return {static_cast<uint32_t>(number >> 32), static_cast<uint32_t>(number), scene.settings.seed};
}

/// Starts the particles of samples `first`, first + 1, ... of `samples` as subpaths 0, 1, ...
struct BeginParticles {
    WalkScene scene;
    WalksView walks;
    BeginOrder samples;
    uint64_t first;

    HD void operator()(uint32_t i) const {
        const SubpathSettings& settings = scene.settings;
        WalkState state = state_of_sample(samples, first + i, scene.picture.camera);
        if (walks.room.kept > 0) walks.kept_counts[i] = 0;
        const SampleKey key = particle_sample_key(scene, state.pixel, state.sample);
        const SampleBits place = sample_bits(settings.sampler, key, kGroupLight);
        const Vec2 direction = sample_2d(settings.sampler, key, kGroupLight, Pair::Last);
        const uint32_t coin = coin_key({state.pixel, state.sample, settings.seed ^ kParticleCoins}, 0, false);
        Particle particle;
        if (!emit_particle(scene.picture.scene, scene.world, place, direction, coin, particle)) return;
        if (!(max_component(particle.power) > 0)) return;
        state.throughput = particle.power;
        state.mis = particle.mis;
        state.is_from_far = particle.is_from_far ? 1 : 0;
        walks.states[i] = state;
        walks.squared_indices[i] = 1;
        walks.queue_ray(atomic_add(&walks.counts->next, 1u), i, particle.ray, particle.start, coin, 0);
    }
};

/// Shades hits of particles: a connection to the camera, a stored vertex, the continuation.
template <MaterialsKnown kKnown>
struct ShadeParticles {
    WalkScene scene;
    WalksView walks;
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const Hit hit = walks.hits().load(i);
        if (hit.instance == kNoHit) return;
        const SubpathSettings& settings = scene.settings;
        const uint32_t walk = walks.owners[round % 2][i];
        const Ray ray = load_ray(walks.rays[round % 2] + i);
        WalkState state = walks.states[walk];
        const Surface surface = make_surface<kKnown>(scene.picture.scene, hit, ray.direction);
        if (state.depth() == 0) state.throughput = left_at(hit.t, ray.t_max) * state.throughput;
        if (surface.is_unlit || is_black(state.throughput)) return;
        state.mis.arrive(cosine_at(surface, ray.direction), state.is_from_far != 0 ? 1.0f : square(hit.t));
        state.is_from_far = 0;

        const bool can_be_joined = !surface.bsdf.has_delta_only();
        if (state.depth() < walks.room.kept) {
            const std::size_t at = walks.kept_place(walk, state.depth());
            if (can_be_joined) {
                walks.kept.store(
                    at, {hit, ray.direction, (1.0f / walks.squared_indices[walk]) * state.throughput, state.mis});
            } else {
                walks.kept.store_none(at);
            }
            walks.kept_counts[walk] = state.depth() + 1;
        }
        const SampleKey key = particle_sample_key(scene, state.pixel, state.sample);
        if (can_be_joined) ask_camera(surface, hit, walk, state, -ray.direction, key);
        if (state.depth() + 1 < settings.max_depth) go_on(surface, walk, state, -ray.direction, key);
    }

private:
    HD INLINE_ON_DEVICE void ask_camera(const Surface& surface, const Hit& hit, uint32_t walk, const WalkState& state,
                                        Vec3 wi, SampleKey key) const {
        const SubpathSettings& settings = scene.settings;
        const CameraRays& camera = scene.picture.camera;
        const Vec2 lens = camera.has_lens() ? sample_2d(settings.sampler, key,
                                                        particle_group(state.depth(), kWalkScatter), Pair::Last)
                                            : Vec2{};
        SeenVertex seen;
        if (!see_vertex(camera, surface.position, lens, seen)) return;
        const AcceptHit accept = {scene.picture.scene, {}, {}, 0};
        if (scene.picture.scene.any_hidden_back != 0 &&
            AcceptCameraHit{accept, seen.direction}.meets_hidden_back(hit.instance, hit.primitive)) {
            return; // the camera sees through its back
        }
        const Vec3 wo = -seen.direction;
        const BothWays scattered = scatter_both_ways<kKnown>(surface, wo, wi);
        if (is_black(scattered.particle.f)) return;
        float weight = 1;
        if (scene.is_joined) {
            const float density = seen.density * cosine_at(surface, wo) / seen.distance_squared;
            weight = mis_weight(squared_density(density) * state.mis.others(scattered.eye.pdf));
        }
        Connection connection;
        // The ray starts on the camera's side, because camera rays pass through hidden backs.
        const Vec3 end = offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wo);
        connection.ray = {seen.from, 0, end - seen.from, 1};
        connection.start = {};
        connection.target = surface.triangle;
        connection.key = coin_key({state.pixel, state.sample, settings.seed ^ kParticleCoins}, state.depth(), true);
        connection.light = (weight * seen.density / seen.distance_squared) * (scattered.particle.f * state.throughput);
        connection.light =
            (1.0f / squared_index_along(surface, wi, wo, walks.squared_indices[walk])) * connection.light;
        const uint32_t place = atomic_add(&walks.counts->asked, 1u);
        walks.ask(place, connection, state.pixel);
        walks.asked_rasters[place] = seen.raster;
    }
    HD INLINE_ON_DEVICE void go_on(const Surface& surface, uint32_t walk, WalkState& state, Vec3 wi,
                                   SampleKey key) const {
        const SubpathSettings& settings = scene.settings;
        const uint32_t choices = particle_group(state.depth(), kWalkChoices);
        const WalkDraw draw =
            draw_scatter(settings, key, surface.bsdf, particle_group(state.depth(), kWalkScatter), choices);
        BsdfSample sample = sample_adjoint(surface, wi, draw.lobe, draw.u);
        if (!(sample.pdf > 0) || !survives(settings, key, choices, state.depth() + 1, sample.weight)) return;
        const Vec3 wo = sample.wi;
        if (scene.is_joined) {
            if (sample.is_delta()) {
                state.mis.scatter_by_delta(cosine_at(surface, wo));
            } else {
                state.mis.scatter(cosine_at(surface, wo), sample.pdf,
                                  scatter_both_ways<kKnown>(surface, wo, wi).eye.pdf);
            }
        }
        if (sample.is_transmission) {
            walks.squared_indices[walk] = squared_index_beyond(surface, wi, walks.squared_indices[walk]);
        }
        state.throughput = state.throughput * sample.weight;
        ++state.scatterings;
        walks.states[walk] = state;
        const Ray ray = {offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wo), 0, wo,
                         kInfinity};
        const uint32_t coin =
            coin_key({state.pixel, state.sample, settings.seed ^ kParticleCoins}, state.depth(), false);
        walks.queue_ray(atomic_add(&walks.counts->next, 1u), walk, ray, surface.triangle, coin, round + 1);
    }
};

/// Adds the particles that the camera sees.
struct AddSplats {
    WalksView walks; // asked_keys hold the tracer's results, kNoHit if the ray hit nothing
    PixelFilterView filter;
    FilmView film;

    HD void operator()(uint32_t i) const {
        if (walks.asked_keys[i] != kNoHit) return;
        const Float4 light = walks.asked_light[i];
        add_splat(film, filter, walks.asked_rasters[i], {light.x, light.y, light.z});
    }
};

/// Adds other connections to their pixels.
struct AddConnections {
    WalksView walks;
    FilmView film;

    HD void operator()(uint32_t i) const {
        if (walks.asked_keys[i] != kNoHit) return;
        const Float4 light = walks.asked_light[i];
        add_radiance(film, bits_of(light.w), {light.x, light.y, light.z});
    }
};

/// Counts in one thread: connections since the last count and, if `ends_round`, the rays that continue. `joined` is
/// the number of light-subpath vertices that each current vertex connects to next.
struct CountWalks {
    WalkCounts* counts;
    bool ends_round;
    uint32_t joined;

    HD void operator()(uint32_t) const {
        counts->all_asked += counts->asked;
        counts->asked = 0;
        counts->pairs = counts->vertices * joined;
        if (!ends_round) return;
        counts->bounces += counts->next;
        counts->rays = counts->next;
        counts->next = counts->vertices = counts->crowded = 0;
    }
};

/// Starts the first round of `rays` in one thread.
struct BeginWalks {
    WalkCounts* counts;
    uint32_t rays;

    HD void operator()(uint32_t) const {
        counts->rays = rays;
        counts->next = counts->asked = counts->vertices = counts->pairs = counts->crowded = 0;
    }
};

// Camera subpaths begin like paths of path tracing, with the same random numbers, so that layers of the first surface
// are equal.

/// Starts the camera subpaths of samples `first`, first + 1, ... of `samples` as subpaths 0, 1, ...
struct BeginEyes {
    WalkScene scene;
    WalksView walks;
    BeginOrder samples;
    uint64_t first;

    HD void operator()(uint32_t i) const {
        const CameraRays& camera = scene.picture.camera;
        WalkState state = state_of_sample(samples, first + i, camera);
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const Ray ray = camera.ray(state.pixel, scene.settings.sampler, key);
        state.throughput = {1, 1, 1};
        state.mis = {min(square(1.0f / camera_density(camera, ray.direction)), kMostOdds), 0};
        state.is_from_far = has_parallel_rays(camera.view.projection) ? 1 : 0;
        walks.states[i] = state;
        walks.queue_ray(i, i, ray, {}, coin_key(key, 0, false), 0);
    }
};

/// Adds auxiliary channels of the first surface, and its emission.
HD INLINE_ON_DEVICE void add_seen(const PictureView& picture, const FilmView& film, const WalkState& state,
                                  const Ray& ray, const Hit& hit, const Surface& surface) {
    add_first_hit(film, state.pixel, state.sample, {ray.origin, ray.direction}, hit, surface, picture);
    if (!is_black(surface.emission)) add_radiance(film, state.pixel, surface.emission);
}
/// Adds the background for a camera ray that hit nothing.
HD inline void add_seen_background(const PictureView& picture, const FilmView& film, const WalkState& state,
                                   const Ray& ray) {
    add_no_first_hit(film, state.pixel, state.sample);
    const LightSetView& lights = picture.scene.lights;
    if (!lights.has_environment() || picture.hide_background) return;
    add_radiance(film, state.pixel, environment_radiance(lights.environment, ray.direction));
}

} // namespace pertev

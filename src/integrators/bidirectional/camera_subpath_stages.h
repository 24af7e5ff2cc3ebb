#pragma once

// Stages of camera subpaths: shade their hits, then connect each vertex to the vertices of the sample's light
// subpath, several at a time.

#include "integrators/subpaths/particle_stages.h"

namespace pertev {

/// Number of light-subpath vertices that a vertex connects to at once.
inline constexpr uint32_t kConnectedAtOnce = 4;

/// The stage that shades hits of camera subpaths: emission, next-event estimation, continuation.
template <ShadingVariant kVariant>
struct ShadeCameraSubpaths {
    SubpathScene scene;
    SubpathsView subpaths;
    FilmView film;
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const PictureView& picture = scene.picture;
        const uint32_t subpath = subpaths.owners[round % 2][i];
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        const Hit hit = subpaths.hits().load(i);
        SubpathState state = subpaths.states[subpath];
        if (hit.instance == kNoHit) return add_background(state, ray);
        const Surface surface = make_surface<kVariant>(picture.scene, hit, ray.direction);
        arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput);
        state.mis.arrive(cosine_at(surface, ray.direction), state.is_from_far != 0 ? 1.0f : square(hit.t));
        state.is_from_far = 0;
        if (state.depth() == 0) {
            add_seen(picture, film, state, ray, hit, surface);
        } else if (!is_black(surface.emission)) {
            add_light(state, light_densities(hit, ray.direction), surface.emission);
        }
        if (surface.is_unlit || state.depth() >= scene.settings.max_depth) return;

        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const Vec3 wo = -ray.direction;
        if (!surface.bsdf.has_delta_only()) {
            sample_direct_light(surface, state, wo, key);
            if (state.depth() + 1 < scene.settings.max_depth && subpaths.kept_counts[subpath] > 0) {
                const uint32_t slot = atomic_add(&subpaths.counts->vertices, 1u);
                subpaths.present.store(slot, {hit, ray.direction, state.throughput, state.mis});
                subpaths.present_owners[slot] = subpath;
            }
        }
        continue_subpath(surface, subpath, state, wo, key);
    }

private:
    HD void add_light(const SubpathState& state, const LightDensities& light, Rgb emission) const {
        add_radiance(film, state.pixel, mis_weight(light.weight_sum(state.mis)) * (state.throughput * emission));
    }
    HD void add_background(const SubpathState& state, const Ray& ray) const {
        if (state.depth() == 0) return add_seen_background(scene.picture, film, state, ray);
        const LightSetView& lights = scene.picture.scene.lights;
        if (!lights.has_environment()) return;
        const float pdf = pdf_environment(lights, ray.origin, ray.direction);
        add_light(state, {pdf, pdf_disc(scene.world)}, environment_radiance(lights.environment, ray.direction));
    }
    HD LightDensities light_densities(const Hit& hit, Vec3 direction) const {
        const LightSetView& lights = scene.picture.scene.lights;
        const uint32_t light = light_of(lights, hit.instance, hit.primitive);
        if (light == kNoLight) return {}; // only this subpath can find it
        const EmissiveTriangle& triangle = lights.triangles[light];
        const float cosine = dot(normalize(cross(triangle.ab, triangle.ac)), direction);
        return {pdf_position(triangle), pdf_emission(triangle, cosine)};
    }

    /// Samples one point of one light, as path tracing does.
    HD INLINE_ON_DEVICE void sample_direct_light(const Surface& surface, const SubpathState& state, Vec3 wo,
                                                 SampleKey key) const {
        const SceneView& view = scene.picture.scene;
        LightSample light;
        const SampleBits bits = sample_bits(scene.settings.sampler, key, light_group(state.depth()), Pair::Last);
        if (!sample_light<emitter_look(kVariant)>(view.lights, surface.light_context(wo), bits, light)) return;
        const BothWays scattered = scatter_both_ways<kVariant>(surface, wo, light.wi);
        if (is_black(scattered.camera.f)) return;
        const uint32_t coin = coin_key(key, state.depth(), true);
        if (light.instance != kNoLight && view.any_alpha != 0 &&
            !AcceptHit{view, {}, {}, coin}.passes_alpha(light.instance, light.primitive, light.b1, light.b2)) {
            return; // transparent part of the light
        }
        const float found = light.is_delta ? 0.0f : squared_density(scattered.camera.pdf / light.pdf);
        const float arriving = density_from(light) * cosine_at(surface, light.wi);
        const float weight =
            mis_weight(found + squared_density(arriving) * state.mis.weight_sum(scattered.particle.pdf));
        Connection connection;
        connection.ray = ray_to_light(light, surface.position, surface.error, surface.geometric_normal);
        connection.start = surface.triangle;
        connection.target = light.is_delta ? TriangleId{} : TriangleId{light.instance, light.primitive};
        connection.key = coin;
        if constexpr (kVariant == ShadingVariant::General) {
            light.radiance = light.radiance * transmittance_to_light<kVariant>(view, surface.triangle, light);
        }
        connection.light = (weight / light.pdf) * (state.throughput * scattered.camera.f * light.radiance);
        subpaths.queue_connection(atomic_add(&subpaths.counts->connections, 1u), connection, state.pixel);
    }
    /// Density, in 1/m2 across its direction, with which a particle from the sampled point arrives at the surface.
    HD float density_from(const LightSample& light) const {
        const LightSetView& lights = scene.picture.scene.lights;
        if (light.distance == kInfinity) return pdf_disc(scene.world);
        const float inverse = 1.0f / square(light.distance);
        if (light.is_delta) {
            return inverse * pdf_emission(lights.punctual[light.primitive], scene.world, -light.wi, lights.goniometric);
        }
        const uint32_t number = light_of(lights, light.instance, light.primitive);
        return inverse * pdf_emission(lights.triangles[number], dot(light.light_normal, light.wi));
    }

    HD INLINE_ON_DEVICE void continue_subpath(const Surface& surface, uint32_t subpath, SubpathState& state, Vec3 wo,
                                              SampleKey key) const {
        const SubpathSettings& settings = scene.settings;
        const uint32_t choices = camera_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw =
            draw_scatter(settings, key, surface.bsdf, camera_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = sample_surface<kVariant>(surface, wo, draw.lobe, draw.u);
        if (!(sample.pdf > 0) || !survives(settings, key, choices, state.depth() + 1, sample.weight)) return;
        const Vec3 wi = sample.wi;
        if (sample.is_delta()) {
            state.mis.scatter_by_delta(cosine_at(surface, wi));
        } else {
            state.mis.scatter(cosine_at(surface, wi), sample.pdf,
                              scatter_both_ways<kVariant>(surface, wo, wi).particle.pdf);
        }
        state.throughput = state.throughput * sample.weight;
        ++state.scatterings;
        subpaths.states[subpath] = state;
        const Ray ray = {offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi), 0, wi,
                         kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, surface.triangle,
                           coin_key(key, state.depth(), false), round + 1);
    }
};

/// An end of a connection between two vertices.
struct ConnectedEnd {
    Rgb f;                       // scattered along the connection, per solid angle
    float onwards_density = 0;   // density of the subpath's own continuation along the connection, 1/sr
    float backwards_density = 0; // density of the other subpath's continuation from here backwards, 1/sr
    float cosine = 0;
    Vec3 start; // origin of a ray along the connection
    TriangleId triangle;
};

template <ShadingVariant kVariant>
HD inline ConnectedEnd connect_end(const SceneView& scene, const SubpathVertex& vertex, Vec3 along, bool is_camera) {
    const Surface surface = make_surface<kVariant>(scene, vertex.hit, vertex.direction);
    const Vec3 from = -vertex.direction;
    const BothWays scattered = scatter_both_ways<kVariant>(surface, is_camera ? from : along, is_camera ? along : from);
    ConnectedEnd end;
    end.f =
        is_camera ? scattered.camera.f : (1.0f / squared_index_along(surface, from, along, 1)) * scattered.particle.f;
    end.onwards_density = is_camera ? scattered.camera.pdf : scattered.particle.pdf;
    end.backwards_density = is_camera ? scattered.particle.pdf : scattered.camera.pdf;
    end.cosine = cosine_at(surface, along);
    end.start = offset_ray_origin(surface.position, surface.error, surface.geometric_normal, along);
    end.triangle = surface.triangle;
    return end;
}

/// connect_end(), not inlined in device code.
template <ShadingVariant kVariant>
HD_CALL inline ConnectedEnd connect_end_by_call(const SceneView& scene, const SubpathVertex& vertex, Vec3 along,
                                                bool is_camera) {
    return connect_end<kVariant>(scene, vertex, along, is_camera);
}

/// Makes both ends of a connection along a direction from the first, the camera's; false if an end scatters no light.
template <ShadingVariant kVariant>
HD inline bool connect_ends(const SceneView& scene, const SubpathVertex (&vertices)[2], Vec3 along,
                            ConnectedEnd (&ends)[2]) {
    if constexpr (kVariant == ShadingVariant::General) {
        // Compiled by CUDA 13.0 with any material inlined, the loop below has accessed memory illegally: it counts in a
        // register of the warp, whose threads part in such a body.
        ends[0] = connect_end_by_call<kVariant>(scene, vertices[0], along, true);
        if (is_black(ends[0].f)) return false;
        ends[1] = connect_end_by_call<kVariant>(scene, vertices[1], -along, false);
        return !is_black(ends[1].f);
    } else {
        for (int k = 0; k < 2; ++k) { // one after the other, because a kernel has room for one surface
            ends[k] = connect_end<kVariant>(scene, vertices[k], k == 0 ? along : -along, k == 0);
            if (is_black(ends[k].f)) return false;
        }
        return true;
    }
}

HD inline Vec3 position_of(const SceneView& scene, const Hit& hit) {
    const InstanceView& instance = scene.instances[hit.instance];
    return world_triangle(instance, scene.meshes[instance.mesh], hit).position;
}

/// The stage that connects pair i: the current round's vertex i % vertices and vertex first + i / vertices of its
/// sample's light subpath.
template <ShadingVariant kVariant>
struct ConnectSubpaths {
    SubpathScene scene;
    SubpathsView subpaths;
    uint32_t first, round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const uint32_t vertices = subpaths.counts->vertices, present = i % vertices, number = first + i / vertices;
        const uint32_t subpath = subpaths.present_owners[present];
        if (number >= subpaths.kept_counts[subpath] || round + number + 2 > scene.settings.max_depth) return;
        const std::size_t at = subpaths.kept_index(subpath, number);
        if (!subpaths.kept.is_there(at)) return;
        const SceneView& view = scene.picture.scene;
        const SubpathVertex ends[2] = {subpaths.present.load(present), subpaths.kept.load(at)};
        const Vec3 way = position_of(view, ends[1].hit) - position_of(view, ends[0].hit);
        const float distance_squared = length_squared(way);
        if (!(distance_squared > 0)) return;
        const Vec3 along = way / sqrt(distance_squared);
        ConnectedEnd connected[2];
        if (!connect_ends<kVariant>(view, ends, along, connected)) return;
        const ConnectedEnd &camera = connected[0], &particle = connected[1];
        const float inverse = 1.0f / distance_squared;
        const float by_camera = camera.onwards_density * particle.cosine * inverse;
        const float by_particle = particle.onwards_density * camera.cosine * inverse;
        const float weight =
            mis_weight(squared_density(by_camera) * ends[1].mis.weight_sum(particle.backwards_density) +
                       squared_density(by_particle) * ends[0].mis.weight_sum(camera.backwards_density));
        const SubpathState& state = subpaths.states[subpath];
        Connection connection;
        connection.ray = {camera.start, 0, particle.start - camera.start, 1};
        connection.start = camera.triangle;
        connection.target = particle.triangle;
        connection.key = coin_key({state.pixel, state.sample, scene.settings.seed ^ kConnectionCoins},
                                  round * 0x1000u + number, true);
        connection.light = (weight * inverse) * (ends[0].throughput * camera.f * particle.f * ends[1].throughput);
        if constexpr (kVariant == ShadingVariant::General) {
            connection.light = connection.light * transmittance_of_solid(view, camera.triangle, particle.triangle,
                                                                         along, sqrt(distance_squared), kAtRest);
        }
        subpaths.queue_connection(atomic_add(&subpaths.counts->connections, 1u), connection, state.pixel);
    }
};

} // namespace pertev

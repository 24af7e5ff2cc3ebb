#pragma once

// Stages of camera subpaths: shade their hits, then connect each vertex to the vertices of the sample's light
// subpath, several at a time.

#include "integrators/subpaths/particle_stages.h"

namespace pertev {

/// Number of light-subpath vertices that a vertex connects to at once.
inline constexpr uint32_t kConnectedAtOnce = 4;

/// The stage that shades hits of camera subpaths, and scatterings in media: emission, next-event estimation,
/// continuation. kInMedia is for scenes with media. `Choice` selects lights (shading/light_set.h).
template <ShadingVariant kVariant, bool kInMedia = false, class Choice = ChosenByPower>
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
        if constexpr (kInMedia) {
            shade_in_media(i, hit, subpath, ray, state);
        } else {
            if (hit.instance == kNoHit) return add_background(state, ray);
            const Surface surface = make_surface<kVariant>(picture.scene, hit, ray.direction);
            arrive_through_solids<kVariant>(scene, subpaths, i, round, ray, hit, state.throughput);
            state.mis.arrive(cosine_at(surface, ray.direction), state.is_from_far != 0 ? 1.0f : square(hit.t));
            state.is_from_far = 0;
            shade_surface(surface, hit, ray, subpath, state, {});
        }
    }

private:
    HD INLINE_ON_DEVICE void shade_in_media(uint32_t i, const Hit& hit, uint32_t subpath, const Ray& ray,
                                            SubpathState& state) const {
        const PictureView& picture = scene.picture;
        InteriorList list = state.depth() == 0 ? picture.camera.interior : subpaths.load_interior(subpath);
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const SubpathFlight flight = fly(scene, key, state.depth(), ray, hit, false, list, state.throughput);
        const float squared = flight.distance < kInfinity ? square(flight.distance) : 1.0f;
        const float distance_factor = (state.is_from_far != 0 ? 1.0f : squared) / flight.probability;
        state.is_from_far = 0;
        if (!flight.is_scattered && hit.instance == kNoHit) {
            state.mis.arrive(1, 1.0f / flight.probability);
            return add_background(state, ray);
        }
        if (flight.is_scattered) {
            if (state.depth() == 0) add_behind_medium<kVariant>(picture, film, state, ray, hit);
            const MediumEnd end = {flight.point, ray.direction, flight.share};
            state.mis.arrive(end.density_factor(ray.direction), distance_factor);
            if (is_black(state.throughput) || state.depth() >= scene.settings.max_depth) return;
            return shade_vertex(end, SubpathVertex::hit_in_medium(end.position()), ray.direction, subpath, state, list);
        }
        Surface surface = make_surface<kVariant>(picture.scene, hit, ray.direction);
        state.throughput =
            reach_surface(picture.scene, list, subpaths.start_of(i, round), ray.direction, hit, surface) *
            state.throughput;
        state.mis.arrive(cosine_at(surface, ray.direction), distance_factor);
        shade_surface(surface, hit, ray, subpath, state, list);
    }
    HD INLINE_ON_DEVICE void shade_surface(const Surface& surface, const Hit& hit, const Ray& ray, uint32_t subpath,
                                           SubpathState& state, InteriorList list) const {
        if (state.depth() == 0) {
            add_seen(scene.picture, film, state, ray, hit, surface, kInMedia ? state.throughput : Rgb{1, 1, 1});
        } else if (!is_black(surface.emission)) {
            const LightContext before = light_context_before<Choice>(subpaths, subpath, ray.origin);
            add_light(state, light_densities(hit, ray.direction, before), surface.emission);
        }
        if (surface.is_unlit || state.depth() >= scene.settings.max_depth) return;
        shade_vertex(SurfaceEnd<kVariant>{surface}, hit, ray.direction, subpath, state, list);
    }
    /// Shades a vertex at which the subpath arrives along `direction`; `list` has the solids that hold it there.
    template <class End>
    HD INLINE_ON_DEVICE void shade_vertex(const End& end, const Hit& hit, Vec3 direction, uint32_t subpath,
                                          SubpathState& state, InteriorList list) const {
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const Vec3 wo = -direction;
        if (!end.scatters_by_delta_alone()) {
            sample_direct_light(end, state, wo, key, list);
            if (state.depth() + 1 < scene.settings.max_depth && subpaths.kept_counts[subpath] > 0) {
                const uint32_t slot = atomic_add(&subpaths.counts->vertices, 1u);
                subpaths.present.store(slot, {hit, direction, state.throughput, state.mis});
                if constexpr (kInMedia) subpaths.present.store_interior(slot, list);
                subpaths.present_owners[slot] = subpath;
            }
        }
        continue_subpath(end, subpath, state, wo, key, list);
    }
    HD void add_light(const SubpathState& state, const LightDensities& light, Rgb emission) const {
        const float others = Choice::kReadsNormal ? light.weight_sum_by_tree(state.mis) : light.weight_sum(state.mis);
        add_radiance(film, state.pixel, mis_weight(others) * (state.throughput * emission));
    }
    HD void add_background(const SubpathState& state, const Ray& ray) const {
        if (state.depth() == 0) {
            return add_seen_background(scene.picture, film, state, ray, kInMedia ? state.throughput : Rgb{1, 1, 1});
        }
        const LightSetView& lights = scene.picture.scene.lights;
        if (!lights.has_environment()) return;
        const float pdf = pdf_environment(lights, ray.origin, ray.direction);
        add_light(state, {pdf, pdf_disc(scene.world)}, environment_radiance(lights.environment, ray.direction));
    }
    /// Returns the densities of the light at a hit; 0 if only this subpath can find it. `before` is the context of the
    /// vertex before the hit.
    HD LightDensities light_densities(const Hit& hit, Vec3 direction, const LightContext& before) const {
        const LightSetView& lights = scene.picture.scene.lights;
        const uint32_t light = light_of(lights, hit.instance, hit.primitive);
        if (light == kNoLight) return {}; // only this subpath can find it
        const EmissiveTriangle& triangle = lights.triangles[light];
        if (!(triangle.pmf > 0)) return {}; // its power is 0 or not finite
        const float cosine = dot(normalize(cross(triangle.ab, triangle.ac)), direction);
        return {pdf_position(triangle), pdf_emission(triangle, cosine), selection_ratio<Choice>(lights, before, light)};
    }

    /// Samples one point of one light, as path tracing does.
    template <class End>
    HD INLINE_ON_DEVICE void sample_direct_light(const End& end, const SubpathState& state, Vec3 wo, SampleKey key,
                                                 InteriorList list) const {
        const SceneView& view = scene.picture.scene;
        LightSample light;
        const SampleBits bits = sample_bits(scene.settings.sampler, key, light_group(state.depth()), Pair::Last);
        const LightContext context = end.light_context(wo);
        if (!sample_light<emitter_variant(kVariant), Choice>(view.lights, context, bits, light)) return;
        const BothWays scattered = end.scatter(wo, light.wi);
        if (is_black(scattered.camera.f)) return;
        const uint32_t coin = coin_key(key, state.depth(), true);
        if (is_hole(view, light, coin)) return;
        const TriangleId target = triangle_of(light);
        MediumTransmittance through_media;
        if constexpr (kInMedia) {
            through_media = transmittance_of_connection(view, interior_towards(view, list, end, wo, light.wi),
                                                        end.origin_towards(light.wi), light.wi, light.distance,
                                                        end.triangle(), target);
            if (is_black(through_media.transmittance)) return;
        }
        float found = light.is_delta ? 0.0f : squared_density(scattered.camera.pdf / light.pdf);
        float arriving = density_from(light) * end.density_factor(light.wi);
        if constexpr (Choice::kReadsNormal) arriving /= selection_ratio<Choice>(view.lights, context, light);
        if constexpr (kInMedia) {
            found *= square(through_media.probability);
            arriving *= through_media.probability;
        }
        const float weight =
            mis_weight(found + squared_density(arriving) * state.mis.weight_sum(scattered.particle.pdf));
        Connection connection;
        connection.ray = end.ray_to(light);
        connection.start = end.triangle();
        connection.target = target;
        connection.key = coin;
        if constexpr (kInMedia) {
            light.radiance = light.radiance * through_media.transmittance;
        } else if constexpr (kVariant == ShadingVariant::General) {
            light.radiance = light.radiance * transmittance_to_light<kVariant>(view, end.triangle(), light);
        }
        connection.light = (weight / light.pdf) * (state.throughput * scattered.camera.f * light.radiance);
        subpaths.queue_connection(atomic_add(&subpaths.counts->connections, 1u), connection, state.pixel);
    }
    /// Density, in 1/m2 across its direction, with which a particle from the sampled point arrives at the surface.
    HD float density_from(const LightSample& light) const {
        const LightSetView& lights = scene.picture.scene.lights;
        if (light.distance == kInfinity) return pdf_disc(scene.world);
        const float inverse = 1.0f / square(light.distance);
        switch (light.kind()) {
        case SourceKind::Punctual:
            return inverse * pdf_emission(lights.punctual[light.primitive], scene.world, -light.wi, lights.goniometric);
        case SourceKind::Triangle: {
            const uint32_t number = light_of(lights, light.instance, light.primitive);
            return inverse * pdf_emission(lights.triangles[number], dot(light.light_normal, light.wi));
        }
        case SourceKind::Environment: // it is infinitely far
            break;
        }
        return 0;
    }

    template <class End>
    HD INLINE_ON_DEVICE void continue_subpath(const End& end, uint32_t subpath, SubpathState& state, Vec3 wo,
                                              SampleKey key, InteriorList list) const {
        const SubpathSettings& settings = scene.settings;
        const uint32_t choices = camera_group(state.depth(), kSubpathChoices);
        const ScatterDraw draw = end.draw(settings, key, camera_group(state.depth(), kSubpathScatter), choices);
        BsdfSample sample = end.sample_camera(wo, draw);
        if (!(sample.pdf > 0) || !end.survives(settings, key, choices, state.depth() + 1, sample)) return;
        const Vec3 wi = sample.wi;
        if (sample.is_delta()) {
            state.mis.scatter_by_delta(end.density_factor(wi));
        } else {
            state.mis.scatter(end.density_factor(wi), sample.pdf, end.scatter(wo, wi).particle.pdf);
        }
        if constexpr (kInMedia) {
            subpaths.store_interior(subpath, interior_towards(scene.picture.scene, list, end, wo, wi));
        }
        store_light_normal<Choice>(subpaths, subpath, end, wo);
        state.throughput = state.throughput * sample.weight;
        ++state.scatterings;
        subpaths.states[subpath] = state;
        const Ray ray = {end.origin_towards(wi), 0, wi, kInfinity};
        subpaths.queue_ray(atomic_add(&subpaths.counts->next, 1u), subpath, ray, end.triangle(),
                           coin_key(key, state.depth(), false), round + 1);
    }
};

/// The solids that hold a vertex, on the side from which its subpath arrived, in code that knows media.
template <bool kInMedia>
struct SolidsAround {
    InteriorList interior;
};
template <>
struct SolidsAround<false> {};

/// A vertex that is connected.
template <bool kInMedia>
struct VertexToConnect : SubpathVertex, SolidsAround<kInMedia> {
    HD VertexToConnect(const SubpathVerticesView& vertices, std::size_t at) : SubpathVertex(vertices.load(at)) {
        if constexpr (kInMedia) this->interior = vertices.load_interior(at);
    }
};

/// An end of a connection between two vertices. Its solids are those on the side of the connection.
template <bool kInMedia>
struct ConnectedEnd : SolidsAround<kInMedia> {
    Rgb f;                     // scattered along the connection, per solid angle
    float forward_density = 0; // density of the subpath's own continuation along the connection, 1/sr
    float reverse_density = 0; // density of the other subpath's continuation from here backwards, 1/sr
    float density_factor = 0;  // SurfaceEnd::density_factor
    Vec3 start;                // origin of a ray along the connection
    TriangleId triangle;
};

template <bool kInMedia, class End>
HD INLINE_ON_DEVICE ConnectedEnd<kInMedia> connect_vertex(const SceneView& scene, const End& of,
                                                          const VertexToConnect<kInMedia>& vertex, Vec3 along,
                                                          bool is_camera) {
    const Vec3 from = -vertex.direction;
    const BothWays scattered = of.scatter(is_camera ? from : along, is_camera ? along : from);
    ConnectedEnd<kInMedia> end;
    end.f = is_camera ? scattered.camera.f : (1.0f / of.squared_index_along(from, along, 1)) * scattered.particle.f;
    end.forward_density = is_camera ? scattered.camera.pdf : scattered.particle.pdf;
    end.reverse_density = is_camera ? scattered.particle.pdf : scattered.camera.pdf;
    end.density_factor = of.density_factor(along);
    end.start = of.origin_towards(along);
    end.triangle = of.triangle();
    if constexpr (kInMedia) end.interior = interior_towards(scene, vertex.interior, of, from, along);
    return end;
}

template <ShadingVariant kVariant, bool kInMedia>
HD inline ConnectedEnd<kInMedia> connect_end(const SceneView& scene, const VertexToConnect<kInMedia>& vertex,
                                             Vec3 along, bool is_camera) {
    if constexpr (kInMedia) {
        if (vertex.is_in_medium()) {
            const MediumEnd end = {medium_point(scene, vertex.interior, vertex.position_in_medium()), vertex.direction};
            return connect_vertex<kInMedia>(scene, end, vertex, along, is_camera);
        }
    }
    Surface surface = make_surface<kVariant>(scene, vertex.hit, vertex.direction);
    if constexpr (kInMedia) {
        if (scene.nesting.is_there()) nest_surface(scene, vertex.interior, surface);
    }
    return connect_vertex<kInMedia>(scene, SurfaceEnd<kVariant>{surface}, vertex, along, is_camera);
}

/// Calls connect_end(), but is not inlined in device code.
template <ShadingVariant kVariant, bool kInMedia>
HD_CALL inline ConnectedEnd<kInMedia>
connect_end_by_call(const SceneView& scene, const VertexToConnect<kInMedia>& vertex, Vec3 along, bool is_camera) {
    return connect_end<kVariant, kInMedia>(scene, vertex, along, is_camera);
}

/// Makes both ends of a connection along a direction from the first, the camera's; false if an end scatters no light.
template <ShadingVariant kVariant, bool kInMedia>
HD inline bool connect_ends(const SceneView& scene, const VertexToConnect<kInMedia> (&vertices)[2], Vec3 along,
                            ConnectedEnd<kInMedia> (&ends)[2]) {
    if constexpr (kVariant == ShadingVariant::General) {
        // Compiled by CUDA 13.0 with any material inlined, the loop below has accessed memory illegally: it counts in a
        // register of the warp, whose threads part in such a body.
        ends[0] = connect_end_by_call<kVariant, kInMedia>(scene, vertices[0], along, true);
        if (is_black(ends[0].f)) return false;
        ends[1] = connect_end_by_call<kVariant, kInMedia>(scene, vertices[1], -along, false);
        return !is_black(ends[1].f);
    } else {
        for (int k = 0; k < 2; ++k) { // one after the other, because a kernel has room for one surface
            ends[k] = connect_end<kVariant, kInMedia>(scene, vertices[k], k == 0 ? along : -along, k == 0);
            if (is_black(ends[k].f)) return false;
        }
        return true;
    }
}

template <bool kInMedia>
HD inline Vec3 position_of(const SceneView& scene, const SubpathVertex& vertex) {
    if (kInMedia && vertex.is_in_medium()) return vertex.position_in_medium();
    const Hit& hit = vertex.hit;
    const InstanceView& instance = scene.instances[hit.instance];
    return world_triangle(instance, scene.meshes[instance.mesh], hit).position;
}

/// The stage that connects pair i: the current round's vertex i % vertices and vertex first + i / vertices of its
/// sample's light subpath. kInMedia is for scenes with media.
template <ShadingVariant kVariant, bool kInMedia = false>
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
        const VertexToConnect<kInMedia> ends[2] = {{subpaths.present, present}, {subpaths.kept, at}};
        const Vec3 offset = position_of<kInMedia>(view, ends[1]) - position_of<kInMedia>(view, ends[0]);
        const float distance_squared = length_squared(offset);
        if (!(distance_squared > 0)) return;
        const Vec3 along = offset / sqrt(distance_squared);
        ConnectedEnd<kInMedia> connected[2];
        if (!connect_ends<kVariant, kInMedia>(view, ends, along, connected)) return;
        const ConnectedEnd<kInMedia>&camera = connected[0], &particle = connected[1];
        const float inverse = 1.0f / distance_squared;
        float by_camera = camera.forward_density * particle.density_factor * inverse;
        float by_particle = particle.forward_density * camera.density_factor * inverse;
        MediumTransmittance through_media;
        if constexpr (kInMedia) {
            through_media = transmittance_of_connection(view, camera.interior, camera.start, along,
                                                        sqrt(distance_squared), camera.triangle, particle.triangle);
            if (is_black(through_media.transmittance)) return;
            by_camera *= through_media.probability;
            by_particle *= through_media.probability;
        }
        const float weight = mis_weight(squared_density(by_camera) * ends[1].mis.weight_sum(particle.reverse_density) +
                                        squared_density(by_particle) * ends[0].mis.weight_sum(camera.reverse_density));
        const SubpathState& state = subpaths.states[subpath];
        Connection connection;
        connection.ray = {camera.start, 0, particle.start - camera.start, 1};
        connection.start = camera.triangle;
        connection.target = particle.triangle;
        connection.key = coin_key({state.pixel, state.sample, scene.settings.seed ^ kConnectionCoins},
                                  round * 0x1000u + number, true);
        connection.light = (weight * inverse) * (ends[0].throughput * camera.f * particle.f * ends[1].throughput);
        if constexpr (kInMedia) {
            connection.light = connection.light * through_media.transmittance;
        } else if constexpr (kVariant == ShadingVariant::General) {
            connection.light = connection.light * transmittance_of_solid(view, camera.triangle, particle.triangle,
                                                                         along, sqrt(distance_squared), kAtRest);
        }
        subpaths.queue_connection(atomic_add(&subpaths.counts->connections, 1u), connection, state.pixel);
    }
};

} // namespace pertev

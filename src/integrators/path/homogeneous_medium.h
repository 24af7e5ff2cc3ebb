#pragma once

// Homogeneous media for paths: the free flights of device_scene/free_flight.h, and the vertex where one ends.

#include "device_scene/free_flight.h"
#include "integrators/path/path_job.h"
#include "integrators/path/path_state.h"
#include "shading/phase_function.h"

namespace pertev {

/// A scattering in a medium. It has the functions of SurfaceVertex (path_listener.h).
struct MediumVertex {
    Vec3 position, direction; // the direction in which the path arrived, unit
    float g;
    uint32_t instance; // instance that contains the medium; the number of all instances: the scene's

    HD bool scatters_by_delta_alone() const { return false; }
    HD LightContext light_context(float time) const { return {position, time}; }
    HD BsdfValue evaluate(Vec3 wi) const {
        const float density = henyey_greenstein(g, dot(direction, wi));
        return {grey(density), density};
    }
    HD bool draws_lobe() const { return false; }
    HD BsdfSample sample(float, Vec2 u) const {
        const Vec3 wi = sample_henyey_greenstein(g, direction, u);
        return make_bsdf_sample(wi, evaluate(wi), LobeClass::Diffuse);
    }
    HD Vec3 origin_towards(Vec3) const { return position; }
    HD Ray ray_to(const LightSample& light, float emitter_error) const {
        return ray_to_light(light, position, {0, 0, 0}, light.wi, emitter_error);
    }
    HD bool stays(Vec3) const { return true; }
    HD TriangleId triangle() const { return {}; }
};

template <Features kFeatures>
struct HomogeneousMedium {
    static constexpr bool kIsVacuum = false;
    HD static bool is_in(const SceneView& scene) { return scene.has_media != 0; }
    using Vertex = MediumVertex;

    HD explicit HomogeneousMedium(const SceneView& scene) : scene_(scene) {}

    HD INLINE_ON_DEVICE bool scatters(const PathJob& job, PathState& path, const Hit& hit, Vertex& vertex) const {
        const float time = (kFeatures & kMoving) != 0 ? path.time : kAtRest;
        const SampleKey key = sample_key<kFeatures>(job, path.pixel, path.sample);
        const SampleBits u = sample_bits(job.settings.sampler, key, kGroupMedium + path.depth, Pair::First);
        MediumPoint point;
        FlownMedia flown;
        if (!sample_free_flight(scene_, path.interior, path.origin, path.direction, hit, kInfinity, time, u,
                                path.throughput, point, flown)) {
            return false;
        }
        vertex = {point.position, path.direction, point.g, point.instance};
        return true;
    }

    HD Rgb transmittance(InteriorList interior, const Ray& ray) const {
        return transmittance_of_media(scene_, interior, ray);
    }

private:
    const SceneView& scene_;
};

} // namespace pertev

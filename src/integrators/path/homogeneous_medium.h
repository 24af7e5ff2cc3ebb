#pragma once

// Homogeneous media for paths: sampling of the distance to the next scattering, and the vertex there. The distance is
// sampled for one colour, selected by the path's throughput, and weighted for all by the balance heuristic: the sum of
// the throughput's colours never grows, so no colour is unbounded where coefficients differ.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 14.2; Wilkie et al., "Hero Wavelength
// Spectral Sampling", EGSR 2014, section 3.3 (one-sample balance heuristic over wavelengths).

#include "device_scene/media_along_ray.h"
#include "integrators/path/path_job.h"
#include "integrators/path/path_state.h"
#include "shading/phase_function.h"

namespace pertev {

/// A scattering in a medium. It has the functions of SurfaceVertex (path_listener.h).
struct MediumVertex {
    Vec3 position, direction; // the direction in which the path arrived, unit
    float g;
    uint32_t instance; // whose medium it is; the number of all instances: the scene's

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

/// The group of the random numbers that select the colour and the distance along the ray that leaves a path's vertex.
/// Groups of vertices stay below it.
inline constexpr uint32_t kGroupMedium = 0x40000000u;

template <Features kFeatures>
struct HomogeneousMedium {
    static constexpr bool kIsVacuum = false;
    using Vertex = MediumVertex;

    HD explicit HomogeneousMedium(const SceneView& scene) : scene_(scene) {}

    HD INLINE_ON_DEVICE bool scatters(const PathJob& job, PathState& path, const Hit& hit, Vertex& vertex) const {
        const bool leaves = hit.instance == kNoHit;
        const float distance = leaves ? kInfinity : hit.t;
        if (!leaves && scene_.nesting.is_there() && scene_.nesting.ranks[hit.instance] != 0) {
            const float time = (kFeatures & kMoving) != 0 ? path.time : kAtRest;
            const bool enters = points_inwards(scene_, {hit.instance, hit.primitive}, path.direction, time);
            path.interior = solids_before(scene_, path.interior, hit.instance, enters);
        }
        const Rgb t = path.throughput;
        const float sum = t.r + t.g + t.b;
        if (!(sum > 0)) return false;
        const SampleKey key = sample_key<kFeatures>(job, path.pixel, path.sample);
        const SampleBits u = sample_bits(job.settings.sampler, key, kGroupMedium + path.depth, Pair::First);
        const float colour = unit_interval(u.x) * sum;
        const auto selected = [&](Rgb rates) {
            return colour < t.r ? rates.r : colour < t.r + t.g ? rates.g : rates.b;
        };
        float left = -log(unit_interval(u.y)); // optical depth before the scattering, in the selected colour

        Rgb depth = {0, 0, 0}, sampled = {0, 0, 0}; // optical depths; the latter of media that scatter
        Rgb scattered = {1, 1, 1}, density = {1, 1, 1}, absorbed = {1, 1, 1};
        float at = kInfinity, position = 0; // metres along the ray
        visit_media(scene_, path.interior, path.origin, path.direction, distance, leaves, [&](const RayPart& part) {
            const MediumParameters& medium = part.material.medium;
            const Rgb sigma_t = medium.sigma_t();
            float length = part.end - part.begin;
            if (medium.scatters()) {
                const float rate = selected(sigma_t);
                const bool is_here = rate > 0 && rate * length > left;
                if (is_here) {
                    length = left / rate, at = part.begin + length;
                    position = within_part(path, at, part);
                    scattered = medium.sigma_s, density = sigma_t;
                    vertex.g = medium.g;
                    const uint32_t rank = path.interior.top();
                    vertex.instance = rank == 0 ? scene_.instance_count : scene_.nesting.solids[rank];
                }
                if (rate > 0) left -= rate * length;
                sampled += optical_depth(sigma_t, length);
            }
            depth += optical_depth(sigma_t, length);
            absorbed = absorbed * absorption_of(part, length);
            return at < kInfinity;
        });
        const Rgb weights = t * density * transmittance_of(sampled);
        const float pdf = weights.r + weights.g + weights.b;
        path.throughput = (sum / pdf) * (t * scattered * absorbed * transmittance_of(depth));
        const bool is_lost = !(pdf > 0) || (at >= kFarthest && at < kInfinity); // no light of the scene is there
        if (is_lost) path.throughput = {0, 0, 0};
        if (is_lost || !(at < kInfinity)) return false;
        vertex.position = path.origin + position * path.direction;
        vertex.direction = path.direction;
        return true;
    }

    HD Rgb transmittance(InteriorList interior, const Ray& ray) const {
        return transmittance_of_media(scene_, interior, ray);
    }

private:
    static constexpr float kFarthest = 0x1p39f; // metres

    /// Keeps a scattering off the surfaces that begin and end its part of the ray, because rounding could move it to
    /// their other side. The path's own vertex, at 0, is on the right side already.
    HD static float within_part(const PathState& path, float at, const RayPart& part) {
        const bool ends = part.end < kInfinity;
        const float margin = 0x1p-20f * (max_component(abs(path.origin)) + (ends ? part.end : at));
        const float least = part.begin > 0 ? part.begin + margin : 0.0f, most = ends ? part.end - margin : kInfinity;
        return least < most ? clamp(at, least, most) : 0.5f * (part.begin + part.end);
    }

    const SceneView& scene_;
};

} // namespace pertev

#pragma once

// Free flights: how far a ray reaches in homogeneous media before it is scattered. The distance is sampled for one
// colour, selected by the throughput, and weighted for all by the balance heuristic: the sum of the throughput's
// colours never grows, so no colour is unbounded where coefficients differ.
//
// Source: Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., section 14.2; Wilkie et al., "Hero Wavelength
// Spectral Sampling", EGSR 2014, section 3.3 (one-sample balance heuristic over wavelengths).

#include "device_scene/media_along_ray.h"
#include "math/sampler.h"

namespace pertev {

/// A point in a medium that scatters a ray.
struct MediumPoint {
    Vec3 position;
    Rgb sigma_t;       // 1/m
    float g;           // mean cosine of the phase function
    uint32_t instance; // instance that contains the medium; the number of all instances: the scene's
};

/// The media that a free flight went through before it ended.
struct FlownMedia {
    Rgb depth = {0, 0, 0}, sampled = {0, 0, 0}; // optical depths; the latter of media that scatter
    Rgb absorbed = {1, 1, 1};                   // transmittance of solids without that of their media

    HD void add(const RayPart& part, float length) {
        const MediumParameters& medium = part.material.medium;
        const Rgb passed = optical_depth(medium.sigma_t(), length);
        if (medium.scatters()) sampled += passed;
        depth += passed;
        absorbed = absorbed * absorption_of(part, length);
    }
    /// Returns the probability that flights are not scattered, as the mean over the colours.
    HD float probability() const {
        const Rgb passed = transmittance_of(sampled);
        return (1.0f / 3.0f) * (passed.r + passed.g + passed.b);
    }
};

/// The group of the random numbers that select the colour and the distance of a free flight. Groups of vertices stay
/// below it.
inline constexpr uint32_t kGroupMedium = 0x40000000u;

/// Keeps a scattering at `at` off the surfaces that begin and end its part of the ray, because rounding could move it
/// to their other side. The ray's own origin, at 0, is on the right side already.
HD inline float within_part(Vec3 origin, float at, const RayPart& part) {
    const bool ends = part.end < kInfinity;
    const float margin = 0x1p-20f * (max_component(abs(origin)) + (ends ? part.end : at));
    const float least = part.begin > 0 ? part.begin + margin : 0.0f, most = ends ? part.end - margin : kInfinity;
    return least < most ? clamp(at, least, most) : 0.5f * (part.begin + part.end);
}

/// Corrects the solids that hold a ray by what it hits, which may be nothing.
HD inline InteriorList interior_before(const SceneView& scene, InteriorList list, Vec3 direction, const Hit& hit,
                                       float time) {
    if (hit.instance == kNoHit || !scene.nesting.is_there() || scene.nesting.ranks[hit.instance] == 0) return list;
    return solids_before(scene, list, hit.instance,
                         points_inwards(scene, {hit.instance, hit.primitive}, direction, time));
}

/// Transmittance of a segment, and the probability that sampled flight passes it.
struct MediumTransmittance {
    Rgb transmittance = {1, 1, 1};
    float probability = 1; // FlownMedia::probability()
};

/// Returns the transmittance along a unit direction over `distance` metres, which may be infinite. `list` has the
/// solids that hold the origin, and afterwards those that hold the end.
HD_CALL inline MediumTransmittance transmittance_through_media(const SceneView& scene, InteriorList& list, Vec3 origin,
                                                               Vec3 direction, float distance) {
    FlownMedia flown;
    visit_media(scene, list, origin, direction, distance, !(distance < kInfinity), [&](const RayPart& part) {
        flown.add(part, part.end - part.begin);
        return false;
    });
    return {flown.absorbed * transmittance_of(flown.depth), flown.probability()};
}

/// Samples a free flight along a ray with a unit direction up to `hit`, or up to its own end at `t_max` metres if it
/// hits no surface, and weights `throughput`. `list` has the solids that hold its origin, and afterwards its end.
/// Returns whether the ray is scattered before the hit, and then sets `point`.
HD INLINE_ON_DEVICE bool sample_free_flight(const SceneView& scene, InteriorList& list, Vec3 origin, Vec3 direction,
                                            const Hit& hit, float t_max, float time, SampleBits u, Rgb& throughput,
                                            MediumPoint& point, FlownMedia& flown) {
    constexpr float kFarthest = 0x1p39f; // metres
    const float farthest = hit.instance == kNoHit ? t_max : hit.t;
    list = interior_before(scene, list, direction, hit, time);
    const Rgb t = throughput;
    const float sum = t.r + t.g + t.b;
    if (!(sum > 0)) return false;
    const float colour = unit_interval(u.x) * sum;
    const auto selected = [&](Rgb rates) { return colour < t.r ? rates.r : colour < t.r + t.g ? rates.g : rates.b; };
    float left = -log(unit_interval(u.y)); // optical depth before the scattering, in the selected colour

    Rgb scattered = {1, 1, 1}, density = {1, 1, 1};
    float at = kInfinity, position = 0; // metres along the ray
    visit_media(scene, list, origin, direction, farthest, !(farthest < kInfinity), [&](const RayPart& part) {
        const MediumParameters& medium = part.material.medium;
        const Rgb sigma_t = medium.sigma_t();
        float length = part.end - part.begin;
        if (medium.scatters()) {
            const float rate = selected(sigma_t);
            const bool is_here = rate > 0 && rate * length > left;
            if (is_here) {
                length = left / rate, at = part.begin + length;
                position = within_part(origin, at, part);
                scattered = medium.sigma_s, density = sigma_t;
                const uint32_t rank = list.top();
                point.g = medium.g;
                point.instance = rank == 0 ? scene.instance_count : scene.nesting.solids[rank];
            }
            if (rate > 0) left -= rate * length;
        }
        flown.add(part, length);
        return at < kInfinity;
    });
    const Rgb weights = t * density * transmittance_of(flown.sampled);
    const float pdf = weights.r + weights.g + weights.b;
    throughput = (sum / pdf) * (t * scattered * flown.absorbed * transmittance_of(flown.depth));
    const bool is_lost = !(pdf > 0) || (at >= kFarthest && at < kInfinity); // no light of the scene is there
    if (is_lost) throughput = {0, 0, 0};
    if (is_lost || !(at < kInfinity)) return false;
    point.position = origin + position * direction;
    point.sigma_t = density;
    return true;
}

} // namespace pertev

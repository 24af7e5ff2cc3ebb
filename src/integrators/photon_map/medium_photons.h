#pragma once

// Caustics in media: L S+ M of lights without size, such as a spot light's beam that a glass ball focuses in fog. No
// camera subpath hits such a light, and no shadow ray passes the glass, so photons find this light alone. A caustic
// photon is stored where a medium scatters it first. A scattering of a camera subpath in that medium estimates
//     L = sum over photons of p(wo, wi) power / (sigma_s 4/3 pi r^3),
// where p is the phase function. All photons within the radius r count, because their grid is the only structure.
//
// Sources: Jensen, Christensen, "Efficient Simulation of Light Transport in Scenes with Participating Media using
// Photon Maps", SIGGRAPH 1998, section 3.2; the radius shrinks by Knaus, Zwicker, "Progressive Photon Mapping: A
// Probabilistic Approach", 2011, section 4.3.

#include "integrators/photon_map/photon_map_view.h"
#include "integrators/subpaths/subpath_media.h"
#include "render/fixed_sum.h"

namespace pertev {

/// Returns the medium of an instance; the number of all instances means the scene's own.
HD inline const MediumParameters& medium_of(const SceneView& scene, uint32_t instance) {
    if (instance == scene.instance_count) return scene.surroundings->medium;
    return scene.materials[scene.instances[instance].material].medium;
}

/// Returns light over the scattering coefficient; 0 where nothing is scattered.
HD inline Rgb over_scattering(Rgb light, Rgb sigma_s) {
    const auto over = [](float x, float sigma) { return sigma > 0 ? x / sigma : 0.0f; };
    return {over(light.r, sigma_s.r), over(light.g, sigma_s.g), over(light.b, sigma_s.b)};
}

/// Returns the radiance, over the square of the refractive index, that the photons of at most `max_scatterings`
/// scatterings make a medium send at `end` along `wo`, for a subpath whose throughput has sigma_s. Those whose light is
/// not finite count in `invalid`.
HD inline Rgb radiance_of_photons(const PhotonMapView& map, const MediumEnd& end, Vec3 wo, uint32_t max_scatterings,
                                  uint64_t* invalid) {
    if (map.count == 0) return {};
    FixedSum sums[3];
    visit_within(map.grid, end.position(), map.radius, [&](const NearPoint& near) {
        const Float4 power = map.photons.powers[near.index], direction = map.photons.directions[near.index];
        if (PhotonsView::scatterings(power) > max_scatterings || bits_of(direction.w) != end.point.instance) return;
        const float phase = end.scatter_camera(wo, {direction.x, direction.y, direction.z}).pdf;
        const Rgb light = phase * Rgb{power.x, power.y, power.z};
        if (!(max_component(light) <= kMaxSampleValue)) {
            atomic_add(invalid, 1);
            return;
        }
        sums[0] = sums[0] + to_fixed(light.r);
        sums[1] = sums[1] + to_fixed(light.g);
        sums[2] = sums[2] + to_fixed(light.b);
    });
    const float per_volume = 0.75f * kInvPi / (square(map.radius) * map.radius);
    return per_volume * Rgb{mean_of(sums[0], 1), mean_of(sums[1], 1), mean_of(sums[2], 1)};
}

} // namespace pertev

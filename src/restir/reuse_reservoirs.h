#pragma once

// Spatial and temporal reuse: combines a pixel's reservoir with those of its neighbours, in the previous frame and
// again in the same frame. It works for any reservoir with the functions of light_reservoir.h and bounce_reservoir.h:
// light_scattered and make_visibility_ray.
//
// Item i, the reservoir of pixel i, is selected by share(i, item i) target(own pixel, item i) weight i, with
//   share(j, x) = count j target(j, x) / sum over all k of count k target(k, x)
// This is the generalised balance heuristic over target functions without visibility (Lin et al., "Generalized
// Resampled Importance Sampling", SIGGRAPH 2022, section 5.1). Each pixel sees its own item, so of the selected item's
// shares only those of pixels that see it count: QueueVisibilityRays and CountVisible test them, one pixel after the
// other, and the weight is divided by their sum. Thus no light is lost or counted twice, whatever the occlusion, at one
// ray per neighbour.

#include "restir/find_neighbours.h"
#include "restir/ris_selection.h"
#include "restir/visibility_rays.h"

namespace pertev {

/// Number of pixels whose reservoirs are combined; the pixel itself is entry 0.
inline constexpr uint32_t kMaxEntries = kMaxNeighbours + 1;

/// Shares of the selected item, by entry.
struct alignas(16) Shares {
    float of[kMaxEntries] = {};
};

template <class Reservoir, ShadingVariant kVariant>
struct ReuseReservoirs {
    SceneView scene;
    PixelSurfaces here, there; // surfaces of entry 0, and of the others
    const Reservoir *own, *others;
    const Neighbours* neighbours;
    Reservoir* to;
    Shares* shares;
    uint32_t group; // group of random numbers

    HD void operator()(uint32_t pixel) const {
        const Reservoir first = own[pixel];
        Reservoir result = first;
        result.source = 0, result.seen = 1;
        Shares result_shares;
        result_shares.of[0] = 1;
        if (first.count > 0 && neighbours[pixel].pixels[0] != kNoPixel) combine(pixel, first, result, result_shares);
        to[pixel] = result;
        shares[pixel] = result_shares;
    }

private:
    HD void combine(uint32_t pixel, const Reservoir& first, Reservoir& result, Shares& result_shares) const {
        Reservoir entries[kMaxEntries];
        float targets[kMaxEntries][kMaxEntries]; // [j][i] target function of pixel j for item i
        entries[0] = first;
        uint32_t count = 1;
        for (uint32_t k = 0; k < kMaxNeighbours && neighbours[pixel].pixels[k] != kNoPixel; ++k) {
            entries[count] = others[neighbours[pixel].pixels[k]];
            entries[count].count = min(entries[count].count, neighbours[pixel].max_count);
            ++count;
        }
        for (uint32_t j = 0; j < count; ++j) {
            for (uint32_t i = 0; i < count; ++i) targets[j][i] = 0;
            if (!(entries[j].count > 0)) continue;
            const PixelSurfaces& surfaces = j == 0 ? here : there;
            const uint32_t seen_by = j == 0 ? pixel : neighbours[pixel].pixels[j - 1];
            const Vec3 direction = surfaces.direction(seen_by);
            const Surface surface = surfaces.surface<kVariant>(scene, seen_by, direction);
            for (uint32_t i = 0; i < count; ++i) {
                if (!(entries[i].weight > 0)) continue;
                targets[j][i] = luminance(light_scattered(scene, surface, -direction, entries[i]));
            }
        }
        RisSelection selection = {sample_1d(here.sampler, here.key(pixel), group)};
        result = {};
        float selected_sum = 0, all = 0;
        for (uint32_t i = 0; i < count; ++i) {
            all += entries[i].count;
            float sum = 0;
            for (uint32_t j = 0; j < count; ++j) sum += entries[j].count * targets[j][i];
            const float share = entries[i].count * targets[i][i] / sum;
            if (!(sum > 0) || !selection.takes(share * targets[0][i] * entries[i].weight)) continue;
            result = entries[i];
            result.source = i;
            selected_sum = sum;
        }
        result.count = all;
        result.weight = 0;
        if (!(selection.sum > 0)) return;
        const uint32_t selected = result.source;
        result.weight = selection.sum / targets[0][selected];
        if (!is_finite(result.weight)) result.weight = 0;
        for (uint32_t j = 0; j < kMaxEntries; ++j) {
            result_shares.of[j] = j < count ? entries[j].count * targets[j][selected] / selected_sum : 0.0f;
        }
        result.seen = result_shares.of[selected];
    }
};

/// The stage that makes a shadow ray to the selected item from the pixel of entry `entry`, if its visibility is
/// unknown.
template <class Reservoir>
struct QueueVisibilityRays {
    SceneView scene;
    PixelSurfaces surfaces; // surfaces of that entry
    const Neighbours* neighbours;
    const Shares* shares;
    Reservoir* reservoirs;
    VisibilityRaysView rays;
    uint32_t entry;

    HD void operator()(uint32_t pixel) const {
        const Reservoir& reservoir = reservoirs[pixel];
        if (!(reservoir.weight > 0) || reservoir.source == entry) return;
        if (entry > 0 && !(shares[pixel].of[entry] > 0)) return;
        const uint32_t from = entry == 0 ? pixel : neighbours[pixel].pixels[entry - 1];
        const WorldTriangle triangle = surfaces.triangle(scene, from);
        const uint32_t coin = surfaces.coin(from);
        Ray ray;
        TriangleId target;
        if (make_visibility_ray(scene, reservoir, triangle, coin, ray, target)) {
            const Hit at = surfaces.hit(from);
            rays.add(ray, {at.instance, at.primitive}, target, coin, pixel);
        } else if (entry == 0) {
            reservoirs[pixel].weight = 0;
        }
    }
};

/// The stage that evaluates the traced shadow rays.
template <class Reservoir>
struct CountVisible {
    VisibilityRaysView rays;
    const Shares* shares;
    Reservoir* reservoirs;
    uint32_t entry;

    HD void operator()(uint32_t i) const {
        Reservoir& reservoir = reservoirs[rays.pixels[i]];
        if (rays.is_free(i)) {
            reservoir.seen += shares[rays.pixels[i]].of[entry];
        } else if (entry == 0) {
            reservoir.weight = 0;
        }
    }
};

/// The stage that divides the weight by the shares of all entries that could have selected the item.
template <class Reservoir>
struct FinishReuse {
    Reservoir* reservoirs;

    HD void operator()(uint32_t pixel) const {
        Reservoir& reservoir = reservoirs[pixel];
        reservoir.weight = reservoir.weight > 0 ? reservoir.weight / reservoir.seen : 0.0f;
    }
};

} // namespace pertev

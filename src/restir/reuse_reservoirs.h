#pragma once

// Spatial and temporal reuse: combines a pixel's reservoir with those of its neighbours, in the previous frame and
// again in the same frame. It works for any reservoir with the functions of light_reservoir.h and bounce_reservoir.h:
// prepare_light, light_scattered and make_visibility_ray.
//
// Item i, the reservoir of pixel i, is selected by share(i, item i) target(own pixel, item i) weight i, with
//   share(j, x) = count j target(j, x) / sum over all k of count k target(k, x)
// This is the generalised balance heuristic over target functions without visibility (Lin et al., "Generalized
// Resampled Importance Sampling", SIGGRAPH 2022, section 5.1). Each pixel sees its own item, so of the selected item's
// shares only those of pixels that see it count: QueueVisibilityRays and CountVisible test them, one pixel after the
// other, and the weight is divided by their sum. Thus no light is lost or counted twice, whatever the occlusion, at one
// ray per neighbour.

#include "device/launch.h"
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
        float counts[kMaxEntries], weights[kMaxEntries];
        decltype(prepare_light(scene, first)) items[kMaxEntries];
        float targets[kMaxEntries][kMaxEntries]; // [j][i] target function of pixel j for item i
        const auto add_entry = [&](uint32_t i, const Reservoir& reservoir, float at_most) {
            counts[i] = min(reservoir.count, at_most);
            weights[i] = reservoir.weight;
            if (reservoir.weight > 0) items[i] = prepare_light(scene, reservoir);
        };
        add_entry(0, first, kInfinity);
        uint32_t count = 1;
        for (uint32_t k = 0; k < kMaxNeighbours && neighbours[pixel].pixels[k] != kNoPixel; ++k) {
            add_entry(count++, others[neighbours[pixel].pixels[k]], neighbours[pixel].max_count);
        }
        for (uint32_t j = 0; j < count; ++j) {
            for (uint32_t i = 0; i < count; ++i) targets[j][i] = 0;
            if (!(counts[j] > 0)) continue;
            const PixelSurfaces& surfaces = j == 0 ? here : there;
            const uint32_t seen_by = j == 0 ? pixel : neighbours[pixel].pixels[j - 1];
            const Receiver<kVariant> receiver = surfaces.receiver<kVariant>(scene, seen_by);
            for (uint32_t i = 0; i < count; ++i) {
                if (!(weights[i] > 0)) continue;
                targets[j][i] = luminance(light_scattered(scene, receiver, items[i]));
            }
        }
        RisSelection selection = {sample_1d(here.sampler, here.key(pixel), group)};
        uint32_t selected = 0;
        float selected_sum = 0, all = 0;
        for (uint32_t i = 0; i < count; ++i) {
            all += counts[i];
            float sum = 0;
            for (uint32_t j = 0; j < count; ++j) sum += counts[j] * targets[j][i];
            const float share = counts[i] * targets[i][i] / sum;
            if (!(sum > 0) || !selection.takes(share * targets[0][i] * weights[i])) continue;
            selected = i;
            selected_sum = sum;
        }
        result = {};
        if (selection.sum > 0) result = selected == 0 ? first : others[neighbours[pixel].pixels[selected - 1]];
        result.source = selected;
        result.count = all;
        result.weight = 0;
        if (!(selection.sum > 0)) return;
        result.weight = selection.sum / targets[0][selected];
        if (!is_finite(result.weight)) result.weight = 0;
        for (uint32_t j = 0; j < kMaxEntries; ++j) {
            result_shares.of[j] = j < count ? counts[j] * targets[j][selected] / selected_sum : 0.0f;
        }
        result.seen = result_shares.of[selected];
    }
};

/// The stage that makes a shadow ray to the selected item from the pixel of entry `entry`, if its visibility is
/// unknown. It runs in whole blocks, because single threads that append would wait for one another.
template <class Reservoir>
struct QueueVisibilityRays {
    static constexpr BlockShape kShape = {128, 6};

    SceneView scene;
    PixelSurfaces surfaces; // surfaces of that entry
    const Neighbours* neighbours;
    const Shares* shares;
    Reservoir* reservoirs;
    VisibilityRaysView rays;
    uint32_t entry, first_pixel;

    HD void operator()(uint32_t i, bool is_pixel) const {
        const BlockAppend<1> list;
        const uint32_t pixel = first_pixel + i;
        bool adds = is_pixel && needs_ray(pixel);
        Ray ray;
        TriangleId start, target;
        uint32_t coin = 0;
        if (adds) {
            const uint32_t from = entry == 0 ? pixel : neighbours[pixel].pixels[entry - 1];
            const WorldTriangle triangle = surfaces.triangle(scene, from);
            const Hit at = surfaces.hit(from);
            coin = surfaces.coin(from);
            start = {at.instance, at.primitive};
            adds = make_visibility_ray(scene, reservoirs[pixel], triangle, coin, ray, target);
            if (!adds && entry == 0) reservoirs[pixel].weight = 0;
        }
        const ListSlots<1> slot = list.take({rays.count}, {adds});
        if (adds) rays.store(slot.at[0], ray, start, target, coin, pixel);
    }

private:
    HD bool needs_ray(uint32_t pixel) const {
        const Reservoir& reservoir = reservoirs[pixel];
        if (!(reservoir.weight > 0) || reservoir.source == entry) return false;
        return entry == 0 || shares[pixel].of[entry] > 0;
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

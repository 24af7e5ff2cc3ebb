#pragma once

// Sorts the hits of a round by shading group, so that blocks which run side by side fetch the same code (after the
// queues by material of Laine, Karras and Aila, "Megakernels Considered Harmful", HPG 2013, section 4). The code of all
// lobes is larger than the caches of instructions.

#include "device/block_order.h"
#include "device/launch.h"
#include "device_scene/scene_view.h"
#include "integrators/path/path_queues.h"
#include "shading/shading_groups.h"

namespace pertev {

/// Hits of the paths of a round.
struct RoundHits {
    HitQueueView hits;
    RoundCounts* round;
    uint32_t last; // slot of the first new path

    /// Returns the slot of the path at index i: those that continue come first, and those that begin lie at the end.
    HD uint32_t slot_of(uint32_t i) const { return i >= round->going_on ? last - (i - round->going_on) : i; }
    /// Returns the shading group of the hit of the path at index i; 0 for a miss.
    HD uint32_t group_of(const SceneView& scene, uint32_t i) const {
        static_assert(kMaxShadingGroup < kBlockKeys - 1); // the last key is that of threads without a path
        const uint32_t instance = hits.load_instance(slot_of(i));
        return instance == kNoHit ? 0u : scene.shading_groups[scene.instances[instance].material];
    }
};

/// The stage that counts the hits of each shading group.
struct CountGroups {
    SceneView scene;
    RoundHits hits;

    static constexpr BlockShape kShape = {512, 2};
    HD void operator()(uint32_t i, bool is_there) const {
        append_by_key(hits.round->in_group, is_there ? hits.group_of(scene, i) : 0u, is_there);
    }
};

/// The stage that writes the indices of a round's paths to `order`, sorted by shading group.
struct OrderHits {
    SceneView scene;
    RoundHits hits;
    uint32_t* order;

    static constexpr BlockShape kShape = {512, 2};
    HD void operator()(uint32_t i, bool is_there) const {
        const uint32_t group = is_there ? hits.group_of(scene, i) : 0u;
        uint32_t slot = append_by_key(hits.round->ordered, group, is_there);
        if (!is_there) return;
        for (uint32_t k = 0; k < group; ++k) slot += hits.round->in_group[k];
        order[slot] = i;
    }
};

} // namespace pertev

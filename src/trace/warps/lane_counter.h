#pragma once

// SIMD efficiency of a traversal: the number of active lanes when a warp tests a node or a triangle, and of the
// 32-byte sectors that these loads touch. On the host a warp is one ray. It is for counting runs, because it slows
// traversal down many times.
//
// Which lanes test together depends on timing, so the figures may differ slightly between two runs.

#include <cstdint>

#include "device/atomics.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// Sums over all warps. A request is one load of 16 bytes per lane; 32 distant lanes touch 32 sectors, neighbours 16,
/// and lanes at one address 1.
struct LaneCounts {
    uint64_t node_steps = 0, node_lanes = 0, node_requests = 0, node_sectors = 0;
    uint64_t triangle_steps = 0, triangle_lanes = 0, triangle_requests = 0, triangle_sectors = 0;
};

struct LaneCounter {
    LaneCounts* counts; // in device memory

    template <class Node>
    HD void add_node(const Node* at) const {
        add(at, counts->node_steps, counts->node_lanes, counts->node_requests, counts->node_sectors);
    }
    template <class Triangle>
    HD void add_triangle(const Triangle* at) const {
        add(at, counts->triangle_steps, counts->triangle_lanes, counts->triangle_requests, counts->triangle_sectors);
    }

private:
    template <class T>
    HD static void add(const T* at, uint64_t& steps, uint64_t& lanes, uint64_t& requests, uint64_t& sectors) {
        constexpr unsigned kRequests = sizeof(T) < 16 ? 1 : sizeof(T) / 16;
        const LaneMask here = lanes_here();
        unsigned touched = 0;
        for (unsigned i = 0; i < kRequests; ++i) {
            const uint64_t sector = (reinterpret_cast<uint64_t>(at) + 16 * i) / 32;
            touched += static_cast<unsigned>(count_lanes(ballot(here, is_first_lane(lanes_with_same(here, sector)))));
        }
        if (!is_first_lane(here)) return;
        atomic_add(&steps, uint64_t(1));
        atomic_add(&lanes, static_cast<uint64_t>(count_lanes(here)));
        atomic_add(&requests, uint64_t(kRequests));
        atomic_add(&sectors, uint64_t(touched));
    }
};

} // namespace pertev

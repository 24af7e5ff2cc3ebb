#pragma once

// Traces many rays on the host: consecutive coherent rays in packets, the others in flight; each gets the hit that it
// would get alone. For rays from a camera or towards one light, searching for coherent ones pays; scattered ones
// seldom are.

#include <array>
#include <cstdint>
#include <utility>

#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/every_triangle.h"
#include "trace/wide/traversals_in_flight.h"
#include "trace/wide/wide_packet.h"

namespace pertev {

enum class RayOrder {
    Scattered, // traces all of them in flight
    Together,  // tests whether each eight consecutive rays are coherent
};

/// Traverses the scene with many rays, in packets where they are coherent and otherwise by traverse_scene_in_flight.
template <TraversalOptions kOptions, class F, class RayOf, class AcceptOf, class MakeVisitor, class End>
void traverse_scene_together(const HostTrees& scene, uint32_t count, const RayOf& ray_of, const AcceptOf& accept_of,
                             const MakeVisitor& make_visitor, const End& end_of) {
    using Accept = decltype(accept_of(0));
    using Visitor = decltype(make_visitor(std::declval<const Accept&>(), std::declval<const Ray&>()));
    using Packet = WidePacket<kOptions, Visitor, F>;
    constexpr uint32_t kSize = kWidePacket, kMaxAlone = 256, kViewRays = 3;
    std::array<uint32_t, kMaxAlone> alone;
    uint32_t waiting = 0;
    const auto send_alone = [&] {
        traverse_scene_in_flight<kOptions, F>(
            scene, waiting, [&](uint32_t i) { return ray_of(alone[i]); },
            [&](uint32_t i) { return accept_of(alone[i]); }, make_visitor,
            [&](uint32_t i, const Visitor& visitor) { end_of(alone[i], visitor); });
        waiting = 0;
    };
    const auto put_alone = [&](uint32_t first, uint32_t some) {
        for (uint32_t i = 0; i < some; ++i) alone[waiting++] = first + i;
        if (waiting + kSize > kMaxAlone) send_alone();
    };
    HostTrees instances = scene;
    instances.baked = {};
    const RaysOfScene<kOptions, RayOf, AcceptOf, MakeVisitor, End> through{instances, ray_of, accept_of, make_visitor,
                                                                           end_of};
    uint32_t packets = 0;
    for (uint32_t first = 0; first < count; first += kSize) {
        const uint32_t some = min(count - first, kSize);
        if (packets == 0 && first >= kViewRays * kSize) { // later rays will not be coherent either
            put_alone(first, some);
            continue;
        }
        const auto in_packet = [&](std::size_t k) { return first + min(static_cast<uint32_t>(k), some - 1); };
        [&]<std::size_t... k>(std::index_sequence<k...>) {
            const std::array<Ray, kSize> rays = {ray_of(in_packet(k))...};
            Packet packet(scene.baked, rays.data());
            if (some < kSize / 2 || scene.baked.nodes == nullptr || !packet.is_coherent()) {
                put_alone(first, some);
                return;
            }
            const std::array<Accept, kSize> accepts = {accept_of(in_packet(k))...};
            std::array<Visitor, kSize> visitors = {make_visitor(accepts[k], rays[k])...};
            ++packets;
            packet.run(visitors.data(), static_cast<int>(some));
            for (uint32_t i = 0; i < some; ++i) through.end(first + i, rays[i], visitors[i]);
        }(std::make_index_sequence<kSize>());
    }
    send_alone();
}

/// Traverses the scene with many rays in the way that suits it and their order.
template <TraversalOptions kOptions, bool kAny, class F, class RayOf, class AcceptOf, class MakeVisitor, class End>
void traverse_scene_many(const HostTrees& scene, uint32_t count, RayOrder order, const RayOf& ray_of,
                         const AcceptOf& accept_of, const MakeVisitor& make_visitor, const End& end_of) {
    static_assert(kOptions.is_exact());
    if (is_small(scene)) {
        EveryTriangle<kAny, RayOf, AcceptOf, MakeVisitor, End>(scene.baked, ray_of, accept_of, make_visitor, end_of)
            .run(count);
    } else if (order == RayOrder::Together) {
        traverse_scene_together<kOptions, F>(scene, count, ray_of, accept_of, make_visitor, end_of);
    } else {
        traverse_scene_in_flight<kOptions, F>(scene, count, ray_of, accept_of, make_visitor, end_of);
    }
}

/// Closest hits of `count` rays: hits[i] is that of ray_of(i), among the candidates that accept_of(i) accepts.
template <TraversalOptions kOptions, class F = Floats8, class RayOf, class AcceptOf>
void trace_closest_many(const HostTrees& scene, uint32_t count, RayOrder order, const RayOf& ray_of,
                        const AcceptOf& accept_of, Hit* hits) {
    const auto make_visitor = []<class Accept>(const Accept& accept, const Ray& ray) {
        return ClosestVisitor<Accept>{accept, Hit{.t = ray.t_max}};
    };
    const auto end = [&](uint32_t i, const auto& visitor) { hits[i] = visitor.best; };
    traverse_scene_many<kOptions, false, F>(scene, count, order, ray_of, accept_of, make_visitor, end);
}

/// Occlusion of `count` rays: occluded[i] is whether ray i hits anything.
template <TraversalOptions kOptions, class F = Floats8, class RayOf, class AcceptOf>
void trace_any_many(const HostTrees& scene, uint32_t count, RayOrder order, const RayOf& ray_of,
                    const AcceptOf& accept_of, bool* occluded) {
    const auto make_visitor = []<class Accept>(const Accept& accept, const Ray& ray) {
        return AnyVisitor<Accept>{accept, ray.t_max};
    };
    const auto end = [&](uint32_t i, const auto& visitor) { occluded[i] = visitor.found; };
    traverse_scene_many<kOptions, true, F>(scene, count, order, ray_of, accept_of, make_visitor, end);
}

} // namespace pertev

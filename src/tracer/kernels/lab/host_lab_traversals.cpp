// The other traversals that only a CPU has: eight boxes of one ray, and one box of eight rays, at a time.

#include <algorithm>
#include <array>
#include <utility>

#include "trace/packet_traversal.h"
#include "tracer/kernels/simd_traversals_body.h"

namespace pertev {
namespace {

/// Traces eight consecutive rays, fewer at the end, and returns their hits.
template <TraversalOptions kOptions, bool kAny, class Counter>
std::array<Hit, kPacketRays> trace_packet(const SceneBvhView& scene, const RayBatch& batch, uint64_t first,
                                          const Counter& counter) {
    const uint64_t count = std::min<uint64_t>(kPacketRays, batch.count.value() - first);
    const unsigned active = (1u << count) - 1;
    RayPacket rays{};
    for (uint64_t k = 0; k < count; ++k) rays[k] = batch.query.rays.load(static_cast<uint32_t>(first + k));
    const auto accepts = [&]<std::size_t... k>(std::index_sequence<k...>) {
        return PacketAccepts<AcceptQueued<true>>{AcceptQueued<true>{batch.query, static_cast<uint32_t>(first + k)}...};
    }(std::make_index_sequence<kPacketRays>());
    std::array<Hit, kPacketRays> found;
    if constexpr (kAny) {
        const unsigned hit = trace_packet_any<kOptions>(scene, rays, active, accepts, counter);
        for (uint64_t k = 0; k < count; ++k) found[k].instance = hit >> k & 1 ? 0u : kNoHit;
    } else {
        trace_packet_closest<kOptions>(scene, rays, active, accepts, found, counter);
    }
    return found;
}

/// Calls trace(index of the first ray) for each packet.
template <class Trace>
void for_each_packet(const RayBatch& batch, const Trace& trace) {
    const uint64_t packets = (uint64_t(batch.count.value()) + kPacketRays - 1) / kPacketRays;
    parallel_for(packets, kRaysATask / kPacketRays, [&](uint64_t packet) { trace(packet * kPacketRays); });
}

template <TraversalOptions kOptions, bool kAny>
void trace_packets(Queue&, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    const auto& scene = std::get<SceneBvhView>(trees);
    for_each_packet(batch, [&](uint64_t first) {
        const auto found = trace_packet<kOptions, kAny>(scene, batch, first, NoTraversalCounter{});
        const uint64_t count = std::min<uint64_t>(kPacketRays, batch.count.value() - first);
        for (uint64_t k = 0; k < count; ++k) store_hit<kAny>(hits, static_cast<uint32_t>(first + k), found[k]);
    });
}

/// Counts a node for each ray of the packet that takes part in the test, and a triangle for each ray that tests it.
struct PacketWorkCounter {
    struct OfRay {
        RayWork* work;
        void add_node(const void*) const { ++work->nodes; }
        void add_triangle(const void*) const { ++work->triangles; }
    };
    RayWork* work; // [kPacketRays]

    void add_packet_node(unsigned mask) const {
        for (; mask != 0; mask &= mask - 1) ++work[__builtin_ctz(mask)].nodes;
    }
    OfRay of_ray(std::size_t k) const { return {work + k}; }
};

template <TraversalOptions kOptions, bool kAny>
void count_packets(Queue&, const AnyTrees& trees, const RayBatch& batch, RayWork* work) {
    const auto& scene = std::get<SceneBvhView>(trees);
    for_each_packet(batch, [&](uint64_t first) {
        std::array<RayWork, kPacketRays> counts{};
        trace_packet<kOptions, kAny>(scene, batch, first, PacketWorkCounter{counts.data()});
        std::copy_n(counts.begin(), std::min<uint64_t>(kPacketRays, batch.count.value() - first), work + first);
    });
}

template <TraversalOptions kOptions, bool kAny>
void add_packet_row(std::vector<TraversalKernel>& rows) {
    constexpr TraversalOptions kCompiled = kAny ? for_any_hit(kOptions) : kOptions;
    rows.push_back({TraversalKind::Packet, kOptions, Distribution::OneAThread, kAny, false, true,
                    trace_packets<kCompiled, kAny>, count_packets<kCompiled, kAny>, nullptr, nullptr});
}

template <TraversalOptions kOptions>
void add_packet_rows(std::vector<TraversalKernel>& rows) {
    add_packet_row<kOptions, false>(rows);
    if constexpr (kOptions.rta) add_packet_row<kOptions, true>(rows);
}

} // namespace

void add_host_lab_kernels(std::vector<TraversalKernel>& rows) {
    constexpr TraversalOptions kFast = {.tests = TestKind::Fast};
    add_simd_row<TraversalOptions{.rta = false}, false>(rows);
    add_simd_row<TraversalOptions{.rta = false, .near_first = false}, false>(rows);
    add_simd_row<kFast, false>(rows);
    add_simd_row<kFast, true>(rows);
    add_packet_rows<TraversalOptions{}>(rows);
    add_packet_rows<TraversalOptions{.rta = false}>(rows);
    add_packet_rows<TraversalOptions{.near_first = false}>(rows);
    add_packet_rows<TraversalOptions{.rta = false, .near_first = false}>(rows);
    add_packet_rows<kFast>(rows);
}

} // namespace pertev

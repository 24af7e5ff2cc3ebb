// Rays that share a stack have the hits of single rays, bit for bit: closest and any, with every switch and with any
// of the packet's rays missing. A packet of one ray visits the nodes of the single ray.

#include "trace/packet_traversal.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/instanced_scene.h"
#include "tests/support/options.h"
#include "tests/support/split_bvh.h"
#include "tests/support/stress_meshes.h"
#include "trace/binary/while_while_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

template <TraversalOptions kOptions, class Accept>
void check_packets(const SceneBvhView& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                   const Accept& accept) {
    CAPTURE(kOptions.rta);
    CAPTURE(kOptions.near_first);
    Random random(3);
    uint64_t wrong = 0;
    const Hit untouched = {.t = -1, .u = 2, .v = 3, .instance = 4, .primitive = 5};
    for (std::size_t first = 0; first + kPacketRays <= rays.size(); first += kPacketRays) {
        RayPacket packet;
        std::copy_n(rays.begin() + static_cast<std::ptrdiff_t>(first), kPacketRays, packet.begin());
        const unsigned active = first % 3 == 0 ? 0xffu : random.below(256);
        std::array<Hit, kPacketRays> hits;
        hits.fill(untouched);
        PacketAccepts<Accept> accepts;
        accepts.fill(accept);
        const unsigned found = trace_packet_closest<kOptions>(scene, packet, active, accepts, hits);
        const unsigned any = trace_packet_any<kOptions>(scene, packet, active, accepts);
        for (std::size_t k = 0; k < kPacketRays; ++k) {
            Hit want = expected[first + k];
            if (want.instance == kNoHit) want.t = packet[k].t_max;
            const bool is_active = (active >> k & 1) != 0, hit = is_active && want.instance != kNoHit;
            if (!is_active) want = untouched;
            if (hits[k] == want && (found >> k & 1) == (hit ? 1u : 0u) && (any >> k & 1) == (hit ? 1u : 0u)) continue;
            if (wrong++ == 0) FAIL_CHECK("ray ", first + k, ": ", text_of(packet[k]), " active ", active);
        }
    }
    CHECK(wrong == 0);
}

template <class Accept>
void check_all_options(const SceneBvhView& scene, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                       const Accept& accept) {
    check_packets<TraversalOptions{.rta = true, .near_first = true}>(scene, rays, expected, accept);
    check_packets<TraversalOptions{.rta = true, .near_first = false}>(scene, rays, expected, accept);
    check_packets<TraversalOptions{.rta = false, .near_first = true}>(scene, rays, expected, accept);
    check_packets<TraversalOptions{.rta = false, .near_first = false}>(scene, rays, expected, accept);
}

} // namespace

TEST_CASE("packets match brute force") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(std::string(c.name));
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(400, 20000)), c, 41);
        const std::vector<Hit> all = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const Bvh bvh = build_bvh(c.triangles), split = build_split_bvh(c.triangles, 6);
        check_all_options(scene_of(view_of(bvh)), rays, all, AcceptAll{});
        check_all_options(scene_of(view_of(split)), rays, all, AcceptAll{});
        check_all_options(scene_of(view_of(bvh)), rays, hits_by_brute_force(c.triangles, rays, AcceptSome{}),
                          AcceptSome{});
    }
}

TEST_CASE("packets match brute force over instances, with and without a baked tree") {
    const InstancedScene s = make_instanced_scene(static_cast<uint32_t>(effort(800, 20000)));
    std::vector<BvhView> views;
    for (const Bvh& tree : s.trees) views.push_back(view_of(tree));
    for (const bool with_baked : {false, true}) {
        const SceneBvhView scene = s.scene(views, with_baked ? view_of(s.baked_tree) : BvhView{});
        check_all_options(scene, s.rays, s.hits_by_brute_force(with_baked), AcceptSome{});
    }
}

TEST_CASE("a packet of one ray visits that ray's nodes, and coherent rays share visits") {
    constexpr TraversalOptions kOptions = {};
    const Bvh bvh = build_bvh(triangles_of(make_torus(60, 40)));
    Random random(12);
    uint64_t wrong = 0, alone = 0, together = 0;
    for (int i = 0; i < 500; ++i) {
        RayPacket packet;
        const Vec3 origin = random.point(-3, 3), target = random.point(-1, 1);
        for (Ray& ray : packet) ray = {origin, 0, target + random.point(-0.01f, 0.01f) - origin, kInfinity};
        std::array<Hit, kPacketRays> hits;
        const auto count = [&](unsigned active) {
            uint64_t nodes = 0, triangles = 0;
            trace_packet_closest<kOptions>(scene_of(view_of(bvh)), packet, active, PacketAccepts<AcceptAll>{}, hits,
                                           TraversalCounter{&nodes, &triangles});
            return nodes * 1'000'000 + triangles;
        };
        const auto k = static_cast<unsigned>(i) % kPacketRays;
        uint64_t nodes = 0, triangles = 0;
        Hit hit;
        trace_closest<WhileWhileTraversal<kOptions>>(scene_of(view_of(bvh)), packet[k], AcceptAll{}, hit,
                                                     TraversalCounter{&nodes, &triangles});
        wrong += count(1u << k) != nodes * 1'000'000 + triangles ? 1 : 0;
        alone += nodes;
        together += count(0xff) / 1'000'000;
        wrong += count(0) != 0 ? 1 : 0;
    }
    CHECK(wrong == 0);
    CHECK(together < 2 * alone); // eight rays
    CHECK(together >= alone);
}

// Compressed trees: decoded boxes hold the exact ones at every size of coordinate, slots follow octants, nothing is
// lost, and the checker detects broken trees.

#include "accel/bvh/compressed_bvh.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "accel/builders/build_bvh.h"
#include "base/limits.h"
#include "tests/support/check_traversal.h"
#include "tests/support/check_wide_bvh.h"
#include "tests/support/meshes.h"
#include "tests/support/stress_meshes.h"
#include "trace/intersect/compressed_boxes.h"
#include "trace/wide/compressed_traversal.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Exponents of coordinates, from below the least normal float to the largest allowed one.
constexpr int kScales[] = {-149, -130, -100, -88, -80, -60, -20, 0, 10, 30, 40};

float scaled(float x, int exponent) {
    for (; exponent < -100; exponent += 20) x *= 0x1p-20f; // multiplies in steps, because some powers are not floats
    return x * float_of(static_cast<uint32_t>(127 + exponent) << 23);
}

/// A box near the origin or far from it: thick, flat or a point.
Bounds3 random_box(Random& random, int scale) {
    Bounds3 box;
    const auto point = [&] {
        const Vec3 p = random.point(-1, 1);
        return Vec3{scaled(p.x, scale), scaled(p.y, scale), scaled(p.z, scale)};
    };
    box.extend(point());
    if (random.below(3) != 0) box.extend(point());
    if (random.below(4) == 0) box.hi.y = box.lo.y;
    if (random.below(8) == 0) box.hi.x = 0x1p40f;
    if (random.below(8) == 0) box.lo.z = -0x1p40f;
    return box;
}

} // namespace

TEST_CASE("decoded boxes contain the exact ones and exceed them by less than a quantum at every scale") {
    Random random(2);
    uint32_t least = 255, greatest = 0;
    for (int i = 0; i < 20'000; ++i) {
        Bounds3 slots[8];
        Bounds3 all;
        for (Bounds3& box : slots) {
            if (random.below(4) == 0) continue;
            box = random_box(random, kScales[random.below(std::size(kScales))]);
            all.extend(box);
        }
        if (all.is_empty()) continue;
        CompressedBvhNode node{};
        node.exponents_and_inner = 0xa5000000u;
        set_boxes(node, slots);
        REQUIRE(inner_slots(node) == 0xa5);
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t exponent = node.exponents_and_inner >> 8 * axis & 0xff;
            least = std::min(least, exponent);
            greatest = std::max(greatest, exponent);
            REQUIRE(exponent >= kMinQuantumExponent);
            REQUIRE(exponent <= kMaxQuantumExponent);
            // No finer grid would cover the boxes, except where rounding of its origin decides.
            const float extent = component(all.hi, axis) - component(all.lo, axis);
            const float far = std::max(std::abs(component(all.lo, axis)), std::abs(node.origin[axis]));
            const float place = std::nextafter(far, kInfinity) - far;
            if (exponent > kMinQuantumExponent) REQUIRE(255 * (quantum(node, axis) / 2) <= extent + place);
        }
        for (int s = 0; s < 8; ++s) {
            if (slots[s].is_empty()) continue;
            REQUIRE(holds(node, s, slots[s]));
            // Moving any side inwards by one quantum uncovers the exact box.
            for (int p = 0; p < 6; ++p) {
                CompressedBvhNode tight = node;
                const uint32_t one = 1u << 8 * (s % 4), byte = tight.planes[p][s / 4] >> 8 * (s % 4) & 0xff;
                if (byte == (p % 2 == 0 ? 255u : 0u)) continue;
                tight.planes[p][s / 4] += p % 2 == 0 ? one : 0u - one;
                REQUIRE(!holds(tight, s, slots[s]));
            }
        }
    }
    CHECK(least == kMinQuantumExponent);
    CHECK(greatest == kMaxQuantumExponent);
}

TEST_CASE("compressed trees of all stress meshes, huge and tiny, are valid and lose no triangle") {
    for (const StressMesh& mesh : stress_meshes()) {
        CAPTURE(mesh.name);
        for (const int build_leaf : {1, 4, 40}) {
            const Bvh bvh = build_bvh(mesh.triangles, {.max_leaf = build_leaf, .leaf_cost = 0.1f});
            const CompressedBvh tree = make_compressed_bvh(bvh);
            CHECK(find_fault(tree).value_or("none") == "none");
            CHECK(tree.triangles.size() == mesh.triangles.size());
        }
    }
    for (const int scale : kScales) {
        CAPTURE(scale);
        std::vector<BvhTriangle> triangles = make_soup(500, 0);
        for (BvhTriangle& t : triangles) {
            for (Vec3 BvhTriangle::*corner : {&BvhTriangle::a, &BvhTriangle::b, &BvhTriangle::c}) {
                const Vec3 p = 0.4f * t.*corner;
                t.*corner = {scaled(p.x, scale), scaled(p.y, scale), scaled(p.z, scale)};
            }
        }
        CHECK(find_fault(make_compressed_bvh(build_bvh(triangles))).value_or("none") == "none");
    }
}

TEST_CASE("meshes with grids at the ends of their range match brute force") {
    for (const int scale : {-90, -81, -70, 39}) {
        CAPTURE(scale);
        StressMesh mesh = {"scaled soup", make_soup(400, 0), {}, 1};
        std::vector<Ray> rays = stress_rays(1500, mesh, 3);
        const auto shrink = [&](Vec3 p) { return Vec3{scaled(p.x, scale), scaled(p.y, scale), scaled(p.z, scale)}; };
        for (BvhTriangle& t : mesh.triangles) t.a = shrink(t.a), t.b = shrink(t.b), t.c = shrink(t.c);
        for (Ray& ray : rays) { // directions are not normalised
            ray.origin = shrink(0.4f * ray.origin);
            ray.t_min = scaled(ray.t_min, scale);
            if (ray.t_max < kInfinity) ray.t_max = scaled(ray.t_max, scale);
        }
        const std::vector<Hit> expected = hits_by_brute_force(mesh.triangles, rays, AcceptAll{});
        uint64_t hits = 0;
        for (const Hit& hit : expected) hits += hit.instance != kNoHit ? 1 : 0;
        CHECK(hits > rays.size() / 20);
        const CompressedBvh tree = make_compressed_bvh(build_bvh(mesh.triangles));
        check_traversal<CompressedTraversal<TraversalOptions{}>>(scene_of(view_of(tree)), rays, expected, AcceptAll{});
    }
}

TEST_CASE("a child is visited early by rays of its slot's octant") {
    // Eight boxes at the corners of a cube, in any order, get the slots of their octants.
    std::vector<int> corners(8);
    std::iota(corners.begin(), corners.end(), 0);
    Random random(9);
    for (int i = 0; i < 100; ++i) {
        std::swap(corners[random.below(8)], corners[random.below(8)]);
        WideBvhNode<8> node;
        const auto count = static_cast<int>(1 + random.below(8));
        for (int k = 0; k < 8; ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                const float at = corners[static_cast<std::size_t>(k)] >> axis & 1 ? 1.0f : -1.0f;
                node.planes[2 * axis][k] = at - 0.5f;
                node.planes[2 * axis + 1][k] = at + 0.5f;
            }
            node.child[k] = k < count ? kLeafBit | static_cast<uint32_t>(k) : kNoLink;
        }
        int child_of_slot[8];
        assign_slots(node, child_of_slot);
        uint32_t seen = 0;
        for (int s = 0; s < 8; ++s) {
            if (child_of_slot[s] < 0) continue;
            seen |= 1u << child_of_slot[s];
            if (count == 8) CHECK(corners[static_cast<std::size_t>(child_of_slot[s])] == s);
        }
        CHECK(seen == (1u << count) - 1);
    }
}

TEST_CASE("slots are visited in the order of the ray's octant or in reverse") {
    for (uint32_t mask = 1; mask < 256; ++mask) {
        for (uint32_t octant = 0; octant < 8; ++octant) {
            const Vec3 inv = {octant & 1 ? -1.0f : 2.0f, octant & 2 ? -0x1p-40f : 0x1p72f, octant & 4 ? -3.0f : 1.0f};
            uint32_t first = 0, last = 7;
            while (!(mask >> (first ^ octant) & 1)) ++first;
            while (!(mask >> (last ^ octant) & 1)) --last;
            REQUIRE(nearest_slot(mask, inv) == 1u << (first ^ octant));
            REQUIRE(first_of_slots(mask, slot_order(inv, false)) == 1u << (first ^ octant));
            REQUIRE(first_of_slots(mask, slot_order(inv, true)) == 1u << (last ^ octant));
        }
    }
}

TEST_CASE("a ray along an axis enters few boxes of a compressed tree") {
    const CompressedBvh tree = make_compressed_bvh(build_bvh(triangles_of(make_torus(200, 100))));
    REQUIRE(tree.nodes.size() > 2000);
    Random random(1);
    uint64_t most = 0;
    for (int i = 0; i < 300; ++i) {
        float d[3] = {0.0f, -0.0f, 0.0f};
        d[i % 3] = i % 2 == 0 ? 1.0f : -1.0f;
        Ray ray;
        ray.direction = {d[0], d[1], d[2]};
        ray.origin = random.point(-1, 1) - 4 * ray.direction;
        Hit hit;
        uint64_t nodes = 0, triangles = 0;
        trace_closest<CompressedTraversal<TraversalOptions{}>>(scene_of(view_of(tree)), ray, AcceptAll{}, hit,
                                                               TraversalCounter{&nodes, &triangles});
        most = std::max(most, nodes);
    }
    CHECK(most < 150);
}

TEST_CASE("the checker of compressed trees detects faults") {
    const CompressedBvh sound = make_compressed_bvh(build_bvh(make_soup(2000, 0)));
    REQUIRE(!find_fault(sound));
    const auto with = [&](auto&& change) {
        CompressedBvh broken = sound;
        change(broken);
        return find_fault(broken).has_value();
    };
    int leaf = 0; // changes a slot of the last node
    while ((sound.nodes.back().triangles >> leaf & 1) == 0) ++leaf;
    const uint32_t one = 1u << 8 * (leaf % 4);
    CHECK(with([&](auto& b) { b.nodes.back().planes[0][leaf / 4] += one; }));
    CHECK(with([&](auto& b) { b.nodes.back().planes[5][leaf / 4] -= one; }));
    CHECK(with([&](auto& b) { b.nodes.back().exponents_and_inner -= 1; }));
    CHECK(with([&](auto& b) { b.nodes.back().exponents_and_inner |= 0xff; }));
    CHECK(with([&](auto& b) { b.nodes.back().origin[1] += 0.1f; }));
    CHECK(with([&](auto& b) { b.nodes.back().triangles &= ~(0x010101u << leaf); }));
    CHECK(with([&](auto& b) { b.nodes.back().triangles |= 0x010000u << leaf; }));
    CHECK(with([&](auto& b) { b.nodes.back().triangles |= 0x01000000u << leaf; }));
    CHECK(with([&](auto& b) { b.nodes.back().byte_base += 1; }));
    CHECK(with([&](auto& b) { b.nodes.back().triangle_base += 1; }));
    CHECK(with([&](auto& b) { b.nodes.back().exponents_and_inner |= 1u << (24 + leaf); }));
    CHECK(with([&](auto& b) { b.nodes[0].child_base = 0; }));
    CHECK(with([&](auto& b) { b.nodes[0].child_base = 0x7fffffff; }));
    CHECK(with([&](auto& b) { b.nodes.push_back(b.nodes.back()); }));
    CHECK(with([&](auto& b) { b.triangles.push_back(b.triangles.back()); }));
    CHECK(with([&](auto& b) { b.triangles[7].a.x += 100; }));
    CHECK(with([&](auto& b) { ++b.depth; }));
    // Boxes of a clipped tree need not contain their triangles, but must overlap them.
    CompressedBvh moved = sound;
    moved.nodes.back().origin[1] += 10;
    CHECK(find_fault(moved, true));
    CHECK(!find_fault(sound, true));
}

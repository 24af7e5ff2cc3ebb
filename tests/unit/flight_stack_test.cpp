// The stack of a ray in flight returns each entered child once, in the requested order.

#include "trace/wide/flight_stack.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "tests/support/random.h"
#include "trace/wide/traversals_in_flight.h"

using namespace pertev;
using namespace pertev::test;

namespace {

WideBvhNode<kWideChildren> numbered_node() {
    WideBvhNode<kWideChildren> node{};
    for (uint32_t k = 0; k < kWideChildren; ++k) node.child[k] = 100 + k, node.count[k] = k;
    return node;
}

/// The links of the children of `mask` in the order in which they are popped.
template <TraversalOptions kOptions>
std::vector<uint32_t> order_of(unsigned mask, const float (&entries)[kWideChildren], bool far_first) {
    static const WideBvhNode<kWideChildren> node = numbered_node();
    EnteredChildren children;
    children.entries = _mm256_loadu_ps(entries);
    alignas(32) uint32_t is_in[kWideChildren];
    for (unsigned k = 0; k < kWideChildren; ++k) is_in[k] = mask >> k & 1 ? 0xffffffffu : 0u;
    children.is_in = _mm256_castsi256_ps(_mm256_load_si256(reinterpret_cast<const __m256i*>(is_in)));
    FlightStack stack;
    stack.push<kOptions>(node, children, far_first);
    std::vector<uint32_t> links;
    for (WideEntry entry = stack.pop(); entry.link != kLeafBit; entry = stack.pop()) {
        CHECK(entry.link == 100 + entry.count);
        CHECK(entry.entry == entries[entry.count]);
        links.push_back(entry.link);
    }
    return links;
}

} // namespace

TEST_CASE(
    "the nearest child comes first, or the builder's first, or the farthest, and the others in the builder's order") {
    Random random(2);
    for (unsigned mask = 0; mask < 256; ++mask) {
        for (int started_in = 0; started_in <= 8; ++started_in) { // the average number of entered boxes
            float entries[kWideChildren];
            for (float& entry : entries) {
                entry = random.below(8) < static_cast<uint32_t>(started_in) ? 0.0f : random.within(0, 1000);
            }
            std::vector<uint32_t> builders;
            for (unsigned k = 0; k < kWideChildren; ++k) {
                if (mask >> k & 1) builders.push_back(100 + k);
            }
            CHECK(order_of<TraversalOptions{.near_first = false}>(mask, entries, false) == builders);
            const auto check_first = [&](std::vector<uint32_t> order, bool is_far) {
                REQUIRE(order.size() == builders.size());
                if (order.empty()) return;
                const float first = entries[order[0] - 100];
                for (const uint32_t link : order) { // compared by the upper 16 bits
                    const float other = entries[link - 100];
                    CHECK((is_far ? other <= 1.01f * first : first <= 1.01f * other));
                }
                std::ranges::sort(order);
                CHECK(order == builders);
            };
            const auto far = order_of<TraversalOptions{.near_first = false}>(mask, entries, true);
            check_first(far, true);
            check_first(order_of<TraversalOptions{}>(mask, entries, true), true);
            check_first(order_of<TraversalOptions{}>(mask, entries, false), false);
            if (far.empty()) continue;
            std::erase(builders, far[0]);
            CHECK(std::vector(far.begin() + 1, far.end()) == builders);
        }
    }
}

namespace {

/// Accepts the first candidate and ends the traversal.
struct FirstSeen {
    AcceptAll accept;
    float t_max, seen = -1;
    bool is_far;

    float limit() const { return t_max; }
    bool is_done() const { return seen >= 0; }
    bool visits_far_first() const { return is_far; }
    bool visit(uint32_t, uint32_t, const TriangleHit& hit) {
        seen = hit.t;
        return true;
    }
};

/// Returns the first candidate of rays along x among triangles at x = 1, 2, ... 64.
std::vector<float> first_seen(bool is_far) {
    std::vector<BvhTriangle> triangles(64);
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        const float x = 1 + static_cast<float>(i);
        triangles[i].a = {x, -1, -1}, triangles[i].b = {x, 1, -1}, triangles[i].c = {x, 0, 1};
        triangles[i].primitive = i;
    }
    const WideBvh<kWideChildren> tree = make_wide_bvh<kWideChildren>(build_bvh(triangles));
    HostTrees scene;
    scene.baked = view_of(tree);
    const Ray ray = {{0, 0, 0}, 0, {1, 0, 0}, kInfinity};
    std::vector<float> seen(20);
    traverse_scene_in_flight<TraversalOptions{}, Floats8>(
        scene, static_cast<uint32_t>(seen.size()), [&](uint32_t) { return ray; }, [](uint32_t) { return AcceptAll{}; },
        [&](const AcceptAll&, const Ray& r) { return FirstSeen{.accept = {}, .t_max = r.t_max, .is_far = is_far}; },
        [&](uint32_t i, const FirstSeen& visitor) { seen[i] = visitor.seen; });
    return seen;
}

} // namespace

TEST_CASE("rays in flight begin at their far ends on request") {
    for (const float t : first_seen(false)) CHECK(t <= 4); // a leaf holds four
    for (const float t : first_seen(true)) CHECK(t > 60);
}

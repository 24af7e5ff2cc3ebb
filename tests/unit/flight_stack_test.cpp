// What a ray in flight has still to enter: each child that it enters, once, in the order that is asked for.

#include "trace/wide/flight_stack.h"

#include <doctest/doctest.h>

#include <vector>

#include "tests/support/random.h"

using namespace pertev;
using namespace pertev::test;

namespace {

WideBvhNode<kWideChildren> numbered_node() {
    WideBvhNode<kWideChildren> node{};
    for (uint32_t k = 0; k < kWideChildren; ++k) node.child[k] = 100 + k, node.count[k] = k;
    return node;
}

/// The links of the children of `mask` in the order in which they are popped.
template <WalkOptions kOptions>
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
    for (WideEntry entry = stack.pop(); entry.link != kNoLink; entry = stack.pop()) {
        CHECK(entry.link == 100 + entry.count);
        CHECK(entry.entry == entries[entry.count]);
        links.push_back(entry.link);
    }
    return links;
}

} // namespace

TEST_CASE("children are popped the nearest, the builder's first, or the farthest first, the others as the builder has them") {
    Random random(2);
    for (unsigned mask = 0; mask < 256; ++mask) {
        for (const bool all_at_zero : {false, true}) { // a ray that starts in all of them
            float entries[kWideChildren];
            for (float& entry : entries) entry = all_at_zero ? 0.0f : random.within(0, 1000);
            std::vector<uint32_t> builders;
            for (unsigned k = 0; k < kWideChildren; ++k) {
                if (mask >> k & 1) builders.push_back(100 + k);
            }
            CHECK(order_of<WalkOptions{.near_first = false}>(mask, entries, false) == builders);
            const auto check_first = [&](std::vector<uint32_t> order, float sign) {
                REQUIRE(order.size() == builders.size());
                if (order.empty()) return;
                const float first = sign * entries[order[0] - 100];
                for (const uint32_t link : order) CHECK(first <= sign * entries[link - 100] + 0.01f * first * sign);
            };
            const auto far = order_of<WalkOptions{.near_first = false}>(mask, entries, true);
            check_first(far, -1);
            check_first(order_of<WalkOptions{}>(mask, entries, true), -1);
            check_first(order_of<WalkOptions{}>(mask, entries, false), 1);
            if (far.empty()) continue;
            std::erase(builders, far[0]);
            CHECK(std::vector(far.begin() + 1, far.end()) == builders);
        }
    }
}

#include <algorithm>
#include <vector>

#include <doctest/doctest.h>

#include "integrators/path/order_hits.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("the hits of a round are sorted by shading group, each once") {
    constexpr uint32_t kCapacity = 8192, kGoing = 3001, kActive = 4999, kInstances = 90;
    Queue queue = test::requested_queue();
    test::Random random(7);
    std::vector<uint8_t> groups(kInstances);
    std::vector<InstanceView> instances(kInstances);
    for (uint32_t i = 0; i < kInstances; ++i) {
        groups[i] = static_cast<uint8_t>(1 + random.below(i % 3 == 0 ? 2 : kMaxShadingGroup));
        instances[i].material = kInstances - 1 - i;
    }
    std::vector<uint32_t> hit(kCapacity, 12345); // slots without a path are not read
    const auto slot_of = [](uint32_t i) { return i < kGoing ? i : kCapacity - 1 - (i - kGoing); };
    std::vector<uint32_t> group_of(kActive);
    for (uint32_t i = 0; i < kActive; ++i) {
        const bool misses = random.below(5) == 0;
        const uint32_t instance = random.below(kInstances);
        hit[slot_of(i)] = misses ? kNoHit : instance;
        group_of[i] = misses ? 0 : groups[instances[instance].material];
    }

    const Buffer<uint8_t> device_groups(queue, std::span<const uint8_t>(groups), "groups");
    const Buffer<InstanceView> device_instances(queue, std::span<const InstanceView>(instances), "instances");
    Buffer<uint32_t> device_hits(queue, std::span<const uint32_t>(hit), "hits"), order(queue, kActive, "order");
    const std::vector<RoundCounts> start = {{.going_on = kGoing, .active = kActive}};
    Buffer<RoundCounts> round(queue, std::span<const RoundCounts>(start), "counts");
    SceneView scene = {};
    scene.instances = device_instances.data();
    scene.shading_groups = device_groups.data();
    const RoundHits hits = {{nullptr, device_hits.data()}, round.data(), kCapacity - 1};
    launch(queue, "count_groups", kActive, CountGroups{scene, hits});
    launch(queue, "order_hits", kActive, OrderHits{scene, hits, order.data()});

    std::vector<uint32_t> sorted = order.download();
    CHECK(std::ranges::is_sorted(sorted, {}, [&](uint32_t i) { return group_of.at(i); }));
    std::ranges::sort(sorted);
    for (uint32_t i = 0; i < kActive; ++i) REQUIRE(sorted[i] == i);
    const RoundCounts counted = round.download().front();
    for (uint32_t group = 0; group < kBlockKeys; ++group) {
        CHECK(counted.in_group[group] == std::ranges::count(group_of, group));
    }
}

// Wide trees: the collapse has minimal cost, loses no triangle and gives valid trees; and the checker detects
// broken ones.

#include "accel/bvh/wide_bvh.h"

#include <doctest/doctest.h>

#include <algorithm>

#include "accel/builders/build_bvh.h"
#include "tests/support/check_wide_bvh.h"
#include "tests/support/meshes.h"
#include "tests/support/stress_meshes.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Enumerates all ways to collapse a small tree: each inner node becomes a wide node, is merged into its parent, or
/// becomes a leaf.
class EveryCollapse {
public:
    EveryCollapse(const Bvh& bvh, const CollapseSettings& settings, int width)
        : bvh_(bvh), settings_(settings), width_(width), fate_(bvh.nodes.size()) {}

    float min_cost() {
        float least = kInfinity;
        uint64_t ways = 1;
        for (std::size_t i = 0; i < bvh_.nodes.size(); ++i) ways *= 3;
        for (uint64_t way = 0; way < ways; ++way) {
            uint64_t rest = way;
            for (int& fate : fate_) fate = static_cast<int>(rest % 3), rest /= 3;
            cost_ = 0;
            sound_ = true;
            int children = 0;
            visit(bvh_.root, bvh_.bounds, children, true);
            if (sound_)
                least = std::min(least, static_cast<float>(cost_ / static_cast<double>(bvh_.bounds.half_area())));
        }
        return least;
    }

private:
    enum { kNode, kTakenIn, kLeaf };

    uint32_t triangles_below(uint32_t link) const {
        if (!(link & kLeafBit)) {
            return triangles_below(bvh_.nodes[link].child[0]) + triangles_below(bvh_.nodes[link].child[1]);
        }
        uint32_t count = 1;
        for (uint32_t i = link & ~kLeafBit; !(bvh_.triangles[i].flags & kLastInLeaf); ++i) ++count;
        return count;
    }

    void visit(uint32_t link, const Bounds3& box, int& children, bool is_root) {
        const auto area = static_cast<double>(box.half_area());
        const int fate = link & kLeafBit ? kLeaf : fate_[link];
        if (fate == kTakenIn && !is_root) {
            visit(bvh_.nodes[link].child[0], child_bounds(bvh_.nodes[link], 0), children, false);
            visit(bvh_.nodes[link].child[1], child_bounds(bvh_.nodes[link], 1), children, false);
            return;
        }
        ++children;
        if (fate == kLeaf) {
            const uint32_t count = triangles_below(link), step = static_cast<uint32_t>(settings_.triangles_at_once);
            if (is_root || count > static_cast<uint32_t>(settings_.max_leaf)) sound_ = false;
            cost_ += area * static_cast<double>(settings_.triangle_cost) * ((count + step - 1) / step);
            return;
        }
        cost_ += area * static_cast<double>(settings_.node_cost);
        int below = 0;
        visit(bvh_.nodes[link].child[0], child_bounds(bvh_.nodes[link], 0), below, false);
        visit(bvh_.nodes[link].child[1], child_bounds(bvh_.nodes[link], 1), below, false);
        if (below > width_) sound_ = false;
    }

    const Bvh& bvh_;
    const CollapseSettings settings_;
    const int width_;
    std::vector<int> fate_;
    double cost_ = 0;
    bool sound_ = true;
};

template <int kWidth>
void check_least_cost(const Bvh& bvh, const CollapseSettings& settings) {
    const WideBvh<kWidth> wide = make_wide_bvh<kWidth>(bvh, settings);
    CHECK(wide.sah_cost == doctest::Approx(EveryCollapse(bvh, settings, kWidth).min_cost()).epsilon(1e-5));
}

const CollapseSettings kWideSettings[] = {{},
                                          {.max_leaf = 1},
                                          {.max_leaf = 4, .triangles_at_once = 4, .triangle_cost = 1},
                                          {.max_leaf = 3, .node_cost = 0},
                                          {.max_leaf = 64, .triangle_cost = 0},
                                          {.max_leaf = 16, .triangle_cost = 4}};

} // namespace

TEST_CASE("the chosen collapse of a small tree has minimal cost") {
    for (const uint32_t count : {3u, 7u, 11u, 17u}) {
        std::vector<BvhTriangle> triangles = make_soup(4 * count, 0);
        triangles.resize(count);
        // The trees are small enough to try all ways, with leaves of one or of up to two triangles.
        const Bvh bvh =
            build_bvh(triangles, {.max_leaf = count <= 11 ? 1 : 2, .leaf_cost = count <= 11 ? 1.0f : 0.01f});
        CAPTURE(count);
        REQUIRE(bvh.nodes.size() <= 12);
        for (const CollapseSettings& settings : kWideSettings) {
            if (settings.max_leaf < 2 && count > 11) continue; // its leaves would be split
            check_least_cost<4>(bvh, settings);
            check_least_cost<8>(bvh, settings);
        }
    }
}

TEST_CASE("wide trees of all stress meshes are valid and lose no triangle") {
    for (const StressMesh& mesh : stress_meshes()) {
        CAPTURE(mesh.name);
        for (const int build_leaf : {1, 4, 40}) {
            const Bvh bvh = build_bvh(mesh.triangles, {.max_leaf = build_leaf, .leaf_cost = 0.1f});
            for (const CollapseSettings& settings : kWideSettings) {
                CAPTURE(settings.max_leaf);
                const WideBvh<4> wide4 = make_wide_bvh<4>(bvh, settings);
                const WideBvh<8> wide8 = make_wide_bvh<8>(bvh, settings);
                CHECK(find_fault(wide4).value_or("none") == "none");
                CHECK(find_fault(wide8).value_or("none") == "none");
                CHECK(wide4.triangles.size() == mesh.triangles.size());
                CHECK(wide8.depth <= std::max(bvh.depth, 1) + 4); // large leaves are split in half
                CHECK(wide8.sah_cost <= wide4.sah_cost * 1.00001f);
                for (const auto& node : wide8.nodes) {
                    for (const uint32_t count : node.count) REQUIRE(count <= static_cast<uint32_t>(settings.max_leaf));
                }
            }
        }
    }
}

TEST_CASE("a wide tree shares its binary tree's triangles and has their counts in its nodes") {
    const Bvh bvh = build_bvh(triangles_of(make_torus(30, 20)));
    const std::vector<WideBvhNode<8>> nodes = make_wide_bvh<8>(bvh, kSimdCollapse).nodes;
    std::vector<int> seen(bvh.triangles.size());
    for (const auto& node : nodes) {
        for (int k = 0; k < 8; ++k) {
            for (uint32_t i = 0; i < node.count[k]; ++i) ++seen[(node.child[k] & ~kLeafBit) + i];
        }
    }
    CHECK(std::all_of(seen.begin(), seen.end(), [](int times) { return times == 1; }));
    CHECK(nodes.size() < bvh.nodes.size() / 4);
}

TEST_CASE("the checker of wide trees detects faults") {
    const WideBvh<8> sound = make_wide_bvh<8>(build_bvh(make_soup(2000, 0)));
    REQUIRE(!find_fault(sound));
    const auto with = [&](auto&& change) {
        WideBvh<8> broken = sound;
        change(broken);
        return find_fault(broken).has_value();
    };
    const auto leaf_of = [](WideBvhNode<8>& node) {
        int k = 0;
        while (node.count[k] == 0) ++k;
        return k;
    };
    WideBvhNode<8> last = sound.nodes.back();
    const int leaf = leaf_of(last);
    CHECK(with([&](auto& b) { b.nodes.back().planes[1][leaf] -= 0.01f; }));
    CHECK(with([&](auto& b) { b.nodes.back().planes[4][leaf] += 0.01f; }));
    CHECK(with([&](auto& b) { b.nodes.back().count[leaf] += 1; }));
    CHECK(with([&](auto& b) { b.nodes.back().child[leaf] -= 1; }));
    CHECK(with([&](auto& b) { b.nodes.back().child[leaf] = kNoLink; }));
    CHECK(with([&](auto& b) { b.nodes[0].child[0] = 2; }));
    CHECK(with([&](auto& b) { b.nodes[0].child[0] = 0x7fffffff; }));
    CHECK(with([&](auto& b) { b.nodes.push_back(b.nodes.back()); }));
    CHECK(with([&](auto& b) { b.triangles.push_back(b.triangles.back()); }));
    CHECK(with([&](auto& b) { b.triangles[7].a.x += 100; }));
    CHECK(with([&](auto& b) { b.triangles[7].flags ^= kLastInLeaf; }));
    CHECK(with([&](auto& b) { ++b.depth; }));
    CHECK(with([&](auto& b) { b.bounds.hi.x -= 0.1f; }));
}

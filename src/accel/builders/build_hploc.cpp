// H-PLOC on the host, for layouts other than the compressed one of tracer/hploc/device_builder.h. It makes the same
// binary tree from the same parts (accel/hploc); leaves are then chosen as for every builder.

#include <algorithm>
#include <cstring>

#include "accel/builders/binary_tree.h"
#include "accel/builders/builders.h"
#include "accel/hploc/climb.h"
#include "accel/hploc/leaves.h"
#include "base/parallel_until.h"

namespace pertev {
namespace {

template <class Stage>
void run(uint32_t count, const Stage& stage, Sink& sink) {
    parallel_until(count, 256, sink, [&](uint64_t i) { stage(static_cast<uint32_t>(i)); });
}

/// Positions of the triangles along the curve, and their codes in that order.
struct Curve {
    std::vector<uint32_t> order;
    std::vector<uint64_t> codes;

    Curve(const std::vector<BvhTriangle>& triangles, Sink& sink) : order(triangles.size()), codes(triangles.size()) {
        const auto count = static_cast<uint32_t>(triangles.size());
        hploc::OrderedBounds centres;
        std::memset(&centres, hploc::kNothing, sizeof(centres));
        const uint32_t threads = (count + hploc::kTrianglesAtOnce - 1) / hploc::kTrianglesAtOnce;
        run(threads, hploc::FindBounds{triangles.data(), count, threads, &centres}, sink);
        std::vector<uint64_t> of_triangles(count);
        run(count, hploc::MakeCodes{triangles.data(), &centres, of_triangles.data(), order.data()}, sink);
        hploc::sort_along_curve(of_triangles.data(), order, sink);
        for (uint32_t i = 0; i < count; ++i) codes[i] = of_triangles[order[i]];
    }
};

} // namespace

Bvh build_hploc_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    check_reference_count(2 * static_cast<uint64_t>(triangles.size())); // clusters are nodes
    if (triangles.empty()) return {};
    const auto count = static_cast<uint32_t>(triangles.size());
    Curve curve(triangles, *settings.sink);
    std::vector<hploc::ClusterNode> nodes(2 * static_cast<std::size_t>(count));
    std::vector<hploc::CollapsePlan> plans(count);
    std::vector<hploc::CollapseSize> sizes(count);
    std::vector<hploc::Cluster> clusters(count);
    std::vector<uint32_t> ends(count);
    uint32_t root = 0;
    const hploc::Climb climb = {
        {nodes.data(), plans.data(), sizes.data(), count, {}}, curve.codes.data(), clusters.data(), ends.data(), &root};
    run(count, hploc::StoreLeaves{triangles.data(), curve.order.data(), climb}, *settings.sink);
    run(count, hploc::ClimbFromLeaves{climb}, *settings.sink);

    BinaryTree tree;
    tree.references = std::move(curve.order);
    tree.nodes.resize(nodes.size());
    tree.root = root;
    for (uint32_t i = 0; i < nodes.size(); ++i) {
        settings.sink->check_at(i);
        if (i == count) continue; // this index is unused
        const hploc::ClusterNode& node = nodes[i];
        tree.nodes[i] = node.is_leaf() ? make_leaf(node.box(), i) : BinaryNode{node.box(), {node.left, node.right}};
    }
    return make_bvh(std::move(tree), triangles, settings);
}

} // namespace pertev

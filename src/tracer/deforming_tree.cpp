#include "tracer/deforming_tree.h"

#include <algorithm>
#include <span>

#include "accel/builders/builders.h"
#include "base/error.h"
#include "base/huge_pages.h"
#include "device/launch.h"
#include "tracer/binary_trees.h"
#include "tracer/refit_wide.h"

namespace pertev {

bool can_deform(TreeLayout layout, bool on_cuda) {
    return layout == TreeLayout::Compressed || (layout == TreeLayout::Wide8Simd && !on_cuda);
}

std::vector<BvhTriangle> read_triangles(Queue& queue, const DeformedMesh& mesh) {
    Buffer<BvhTriangle> list(queue, mesh.triangles, "triangles of a deformed mesh");
    launch(queue, "list triangles", mesh.triangles, ListTriangles{mesh, list.data()});
    return list.download();
}

DeformingCompressed::DeformingCompressed(Queue& queue, uint32_t triangles)
    : queue_(queue), triangles_(queue, triangles, "triangles of a deforming mesh"), builder_(queue, triangles) {
    builder_.reserve_refit();
}

void DeformingCompressed::build() {
    builder_.start(triangles_.data(), static_cast<uint32_t>(triangles_.size()));
    built_cost_ = builder_.finish().sah_cost;
    ++builds_;
}

void DeformingCompressed::start(const DeformedMesh& mesh) {
    PERTEV_CHECK(mesh.triangles == triangles_.size());
    launch(queue_, "list triangles", mesh.triangles, ListTriangles{mesh, triangles_.data()});
    if (builds_ == 0) build();
    builder_.start_refit(triangles_.data());
}

Bounds3 DeformingCompressed::finish() {
    const DeviceBuilder::Figures figures = builder_.finish();
    if (figures.refit_cost > kMaxRefitCost * built_cost_) build();
    return figures.bounds;
}

DeformingWide::DeformingWide(Queue& queue, uint32_t triangles) : queue_(queue) {
    PERTEV_CHECK(!queue.is_cuda());
    tree_.triangles.reserve(triangles);
}

void DeformingWide::build(const DeformedMesh& mesh) {
    tree_ = make_wide_bvh<8>(build_bvh(kRefittedBuilder, read_triangles(queue_, mesh)), kSimdCollapse);
    use_huge_pages(std::as_bytes(std::span(tree_.nodes)));
    use_huge_pages(std::as_bytes(std::span(tree_.triangles)));
    for (auto* array : {&parents_, &children_, &arrived_}) array->resize(tree_.nodes.size());
    boxes_.resize(tree_.nodes.size());
    const auto nodes = static_cast<uint32_t>(tree_.nodes.size());
    launch(queue_, "link parents", nodes, LinkWideParents{tree_.nodes.data(), parents_.data(), children_.data()});
    built_cost_ = tree_.sah_cost;
    ++builds_;
}

void DeformingWide::refit(const DeformedMesh& mesh) {
    if (tree_.nodes.empty()) return;
    std::ranges::fill(arrived_, 0u);
    RefitResult result;
    launch(queue_, "refit nodes", static_cast<uint32_t>(tree_.nodes.size()),
           RefitWide{mesh, tree_.nodes.data(), tree_.triangles.data(),
                     UpwardLinks{parents_.data(), children_.data(), arrived_.data(), boxes_.data(), &result},
                     kSimdCollapse});
    tree_.bounds = result.bounds;
    tree_.sah_cost = result.cost;
    if (result.cost > kMaxRefitCost * built_cost_) build(mesh);
}

void DeformingWide::start(const DeformedMesh& mesh) {
    PERTEV_CHECK(builds_ == 0 || mesh.triangles == tree_.triangles.size());
    if (builds_ == 0) {
        build(mesh);
    } else {
        refit(mesh);
    }
}

} // namespace pertev

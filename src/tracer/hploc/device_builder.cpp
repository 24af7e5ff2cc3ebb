#include "tracer/hploc/device_builder.h"

#include <utility>

#include "accel/builders/binary_tree.h"
#include "base/error.h"
#include "base/limits.h"
#include "device/launch.h"
#include "tracer/hploc/hploc_kernels.h"
#include "tracer/hploc/sort_codes.h"

namespace pertev {
namespace {

/// Maximum number of wide nodes over n triangles. The plan leaves no node whose children would fit into empty slots of
/// its parent: if a node has c children, its parent has at least 10 - c. So the number is largest if each node has
/// eight children that are nodes of two triangles. Counts are checked against it nevertheless.
std::size_t max_nodes(uint32_t triangles) { return static_cast<std::size_t>(triangles) * 4 / 7 + 8; }

} // namespace

DeviceBuilder::DeviceBuilder(Queue& queue, uint32_t most, const CollapseSettings& costs)
    : queue_(queue), costs_(costs), centres_(queue, 1, "bounds of triangles' centres"),
      codes_(queue, most, "Morton codes"), sorted_codes_(queue, most, "Morton codes in order"),
      order_(queue, most, "order of triangles"), sorted_order_(queue, most, "order of triangles along the curve"),
      ends_(queue, most, "ends of ranges of leaves"), root_(queue, 1, "root of clusters"),
      sort_scratch_(queue, sort_scratch_bytes(queue, most), "scratch memory for sorting"),
      nodes_(queue, std::size_t(most) * 2, "nodes of clusters"), plans_(queue, most, "plans of wide nodes"),
      sizes_(queue, most, "sizes of subtrees"), clusters_(queue, most, "clusters"),
      items_(queue, max_nodes(most), "positions of wide nodes"),
      item_nodes_(queue, max_nodes(most), "numbers of wide nodes that are placed"),
      counts_(queue, 1, "counts of wide nodes"), wide_(queue, max_nodes(most), "nodes of the built tree"),
      placed_(queue, most, "triangles of the built tree"), sources_(queue, most, "sources of triangles") {
    PERTEV_CHECK(costs.max_leaf >= 1 && costs.max_leaf <= kCompressedLeaf && costs.triangles_at_once == 1);
    check_reference_count(uint64_t(most) * 2); // nodes of clusters
    if (queue.is_cuda()) return;
    level_ = Buffer<uint32_t>(queue, max_nodes(most), "a level of wide nodes");
    next_ = Buffer<uint32_t>(queue, max_nodes(most), "the next level of wide nodes");
    next_count_ = Buffer<uint32_t>(queue, 1, "size of the next level");
}

void DeviceBuilder::start(const BvhTriangle* triangles, uint32_t count, Sink& sink) {
    PERTEV_CHECK(count <= codes_.size());
    triangles_ = triangles;
    count_ = count;
    are_linked_ = is_refitted_ = false;
    if (count == 0) return;
    make_codes(sink);
    climb(sink);
    emit(sink);
}

void DeviceBuilder::make_codes(Sink& sink) {
    centres_.fill(hploc::kNothing);
    const uint32_t threads = (count_ + hploc::kTrianglesAtOnce - 1) / hploc::kTrianglesAtOnce;
    launch(queue_, "find bounds of centres", threads, hploc::FindBounds{triangles_, count_, threads, centres_.data()});
    sink.check();
    launch(queue_, "make Morton codes", count_,
           hploc::MakeCodes{triangles_, centres_.data(), codes_.data(), order_.data()});
    sort_codes(queue_, sort_scratch_, codes_.data(), order_.data(), sorted_codes_.data(), sorted_order_.data(), count_,
               sink);
}

hploc::Climb DeviceBuilder::prepare_climb() const {
    const hploc::ClusterTree tree = {nodes_.data(), plans_.data(), sizes_.data(), count_, costs_};
    return {tree, balanced_ ? nullptr : sorted_codes_.data(), clusters_.data(), ends_.data(), root_.data()};
}

void DeviceBuilder::climb(Sink& sink) {
    const hploc::Climb climb = prepare_climb();
    launch(queue_, "place leaves", count_, hploc::StoreLeaves{triangles_, sorted_order_.data(), climb});
    launch_climb(queue_, climb, sink);
}

hploc::EmitWide DeviceBuilder::prepare_emit() {
    items_.fill(0xff);
    item_nodes_.fill(0xff);
    counts_.fill(0xff);
    hploc::EmitWide emit;
    emit.tree = prepare_climb().tree;
    emit.root = root_.data();
    emit.triangles = triangles_;
    emit.items = items_.data();
    emit.item_nodes = item_nodes_.data();
    emit.nodes = wide_.data();
    emit.placed = placed_.data();
    emit.sources = sources_.data();
    emit.counts = counts_.data();
    emit.capacity = static_cast<uint32_t>(max_nodes(count_));
    return emit;
}

void DeviceBuilder::emit(Sink& sink) {
    const hploc::EmitWide emit = prepare_emit();
    if (launch_emit(queue_, emit)) return;
    *level_.data() = 0;
    for (uint32_t size = 1; size > 0; size = *next_count_.data()) {
        sink.check();
        *next_count_.data() = 0;
        launch(queue_, "make wide nodes", size,
               hploc::EmitLevel{emit, level_.data(), next_.data(), next_count_.data()});
        std::swap(level_, next_);
    }
}

void DeviceBuilder::reserve_refit() {
    parents_.grow(queue_, wide_.size(), "parents of wide nodes");
    children_.grow(queue_, wide_.size(), "counts of wide nodes' children");
    arrived_.grow(queue_, wide_.size(), "counts of children that are refitted");
    boxes_.grow(queue_, wide_.size(), "boxes of wide nodes");
    refitted_.grow(queue_, 1, "bounds and cost of a refitted tree");
}

void DeviceBuilder::start_refit(const BvhTriangle* moved) {
    PERTEV_CHECK(count_ == figures_.triangles);
    if (count_ == 0) return;
    const uint32_t nodes = figures_.nodes;
    reserve_refit();
    if (!are_linked_) {
        launch(queue_, "link parents", nodes, hploc::LinkParents{wide_.data(), parents_.data(), children_.data()});
        are_linked_ = true;
    }
    arrived_.zero();
    launch(queue_, "move triangles", count_, hploc::MoveTriangles{moved, sources_.data(), placed_.data()});
    launch(queue_, "refit nodes", nodes,
           hploc::RefitNodes{
               wide_.data(), placed_.data(),
               UpwardLinks{parents_.data(), children_.data(), arrived_.data(), boxes_.data(), refitted_.data()},
               costs_.node_cost, costs_.triangle_cost});
    is_refitted_ = true;
}

DeviceBuilder::Figures DeviceBuilder::finish() {
    figures_ = {};
    if (count_ == 0) return figures_;
    std::vector<hploc::WideCounts> copy;
    hploc::WideCounts counts = counts_.read(copy).front();
    if (counts.nodes <= max_nodes(count_) && counts.depth > kMaxBvhDepth) {
        const bool was_balanced = std::exchange(balanced_, true);
        PERTEV_CHECK(!was_balanced);
        start(triangles_, count_);
        balanced_ = was_balanced;
        counts = counts_.read(copy).front();
    }
    PERTEV_CHECK(counts.nodes <= max_nodes(count_) && counts.depth <= kMaxBvhDepth);
    figures_ = {counts.nodes, count_, counts.depth, counts.cost, 0, counts.bounds};
    if (is_refitted_) {
        std::vector<RefitResult> of_refit;
        const RefitResult now = refitted_.read(of_refit).front();
        figures_.refit_cost = now.cost;
        figures_.bounds = now.bounds;
    }
    return figures_;
}

CompressedBvh build_compressed_bvh(Queue& queue, std::span<const BvhTriangle> triangles, Sink& sink) {
    const auto count = static_cast<uint32_t>(triangles.size());
    const Buffer<BvhTriangle> there(queue, triangles, "triangles to build over");
    DeviceBuilder builder(queue, count);
    builder.start(there.data(), count, sink);
    builder.finish();
    return builder.download();
}

CompressedBvhView DeviceBuilder::view() const {
    if (figures_.nodes == 0) return {};
    return {wide_.data(), placed_.data(), figures_.bounds.max_abs()};
}

CompressedBvh DeviceBuilder::download() const {
    CompressedBvh bvh;
    if (figures_.nodes == 0) return bvh;
    bvh.nodes.resize(figures_.nodes);
    bvh.triangles.resize(figures_.triangles);
    queue_.copy_to_host(bvh.nodes.data(), wide_.data(), bvh.nodes.size() * sizeof(CompressedBvhNode));
    queue_.copy_to_host(bvh.triangles.data(), placed_.data(), bvh.triangles.size() * sizeof(BvhTriangle));
    bvh.bounds = figures_.bounds;
    bvh.depth = figures_.depth;
    bvh.sah_cost = figures_.sah_cost;
    return bvh;
}

} // namespace pertev

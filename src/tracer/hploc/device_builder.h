#pragma once

// Builds the tree of compressed nodes on the device that its triangles lie on, by H-PLOC (accel/hploc/climb.h). The
// same bytes on every device, whatever the number of threads. All work is given to the queue at once; the host waits
// only for what came out.

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/bvh/bvh.h"
#include "accel/bvh/compressed_bvh.h"
#include "device/buffer.h"
#include "tracer/hploc/emit_wide.h"
#include "tracer/hploc/refit.h"

namespace pertev {

class DeviceBuilder {
public:
    /// Memory for trees of up to `most` triangles: about 280 bytes for each while it builds, and what it makes. Costs:
    /// max_leaf is at most kCompressedLeaf, one triangle at a time. Throws Error(OutOfMemory), Error(OverLimit).
    DeviceBuilder(Queue& queue, uint32_t most, const CollapseSettings& costs = kCompressedCollapse);

    /// Gives the build to the queue and returns. `triangles` are on the device, finite, |coordinate| at most
    /// kMaxCoordinate; count <= most.
    void start(const BvhTriangle* triangles, uint32_t count);

    /// What start() made. Waits. A tree too deep for a walk's stack, which only made-up coordinates give, is built
    /// again of equal halves of the curve. Throws Error(DeviceFault).
    struct Figures {
        uint32_t nodes = 0, triangles = 0;
        int depth = 0;
        float sah_cost = 0;   // as CompressedBvh::sah_cost, of the build
        float refit_cost = 0; // the same of the tree as start_refit() left it; 0: it was not refitted
        Bounds3 bounds;
    };
    Figures finish();

    /// Gives the queue the work of fitting the tree that finish() told of to triangles that have moved: as many, in the
    /// same order, anywhere. finish() then has their bounds and the cost of the tree now.
    void start_refit(const BvhTriangle* moved);
    /// Takes the memory for start_refit. Without this call the first start_refit takes it.
    void reserve_refit();

    /// After finish(): where the tree lies, and a copy on the host.
    CompressedBvhView view() const;
    CompressedBvh download() const;

    /// For tests: what the stages work on, cleared where it has to be, and the binary tree as it was before.
    hploc::Climb prepare_climb() const;
    hploc::EmitWide prepare_emit();
    std::vector<hploc::ClusterNode> download_clusters() const { return nodes_.download(); }

    /// Of equal halves from now on, as after a tree too deep; for tests.
    void set_balanced(bool balanced) { balanced_ = balanced; }

private:
    void make_codes();
    void climb();
    void emit();

    Queue& queue_;
    CollapseSettings costs_;
    bool balanced_ = false;
    const BvhTriangle* triangles_ = nullptr;
    uint32_t count_ = 0;
    Figures figures_;
    Buffer<hploc::OrderedBounds> centres_;
    Buffer<uint64_t> codes_, sorted_codes_;
    Buffer<uint32_t> order_, sorted_order_, ends_, root_, level_, next_, next_count_;
    Buffer<std::byte> sort_scratch_;
    Buffer<hploc::ClusterNode> nodes_;
    Buffer<hploc::CollapsePlan> plans_;
    Buffer<hploc::CollapseSize> sizes_;
    Buffer<hploc::Cluster> clusters_;
    Buffer<hploc::WideItem> items_;
    Buffer<uint32_t> item_nodes_;
    Buffer<hploc::WideCounts> counts_;
    Buffer<CompressedBvhNode> wide_;
    Buffer<BvhTriangle> placed_;
    Buffer<uint32_t> sources_;
    // For refits, made by the first: which node is above each, how many beneath it are done, and boxes.
    Buffer<uint32_t> parents_, children_, arrived_;
    Buffer<NodeBox> boxes_;
    Buffer<RefitResult> refitted_;
    bool are_linked_ = false, is_refitted_ = false;
};

/// Of triangles on the host, and back there; what the laboratory's structure is.
CompressedBvh build_compressed_bvh(Queue& queue, std::span<const BvhTriangle> triangles);

} // namespace pertev

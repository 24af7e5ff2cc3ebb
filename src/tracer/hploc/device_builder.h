#pragma once

// Builds a tree of compressed nodes by H-PLOC (accel/hploc/climb.h) on the device that holds the triangles. The bytes
// are the same on every device and for any number of threads. All work is queued at once; the host waits only for the
// figures.

#include <cstddef>
#include <cstdint>
#include <span>

#include "accel/bvh/bvh.h"
#include "accel/bvh/compressed_bvh.h"
#include "base/sink.h"
#include "device/buffer.h"
#include "tracer/hploc/emit_wide.h"
#include "tracer/hploc/refit.h"

namespace pertev {

class DeviceBuilder {
public:
    /// Allocates for trees of up to `most` triangles: about 280 bytes per triangle during the build, plus the result.
    /// costs.max_leaf is at most kCompressedLeaf, tested one triangle at a time. Throws Error(OutOfMemory),
    /// Error(OverLimit).
    DeviceBuilder(Queue& queue, uint32_t most, const CollapseSettings& costs = kCompressedCollapse);

    /// Queues the build and returns. `triangles` are on the device, finite, with |coordinate| at most kMaxCoordinate;
    /// count <= most. On the CPU, which is done when it returns, `sink` may end it.
    void start(const BvhTriangle* triangles, uint32_t count, Sink& sink = nobody());

    /// Figures of the tree that finish() returns, after waiting for the queue. A tree that is too deep for the
    /// traversal stack, which only contrived coordinates cause, is rebuilt with equal halves of the curve. Throws
    /// Error(DeviceFault).
    struct Figures {
        uint32_t nodes = 0, triangles = 0;
        int depth = 0;
        float sah_cost = 0;   // after the build, as CompressedBvh::sah_cost
        float refit_cost = 0; // after start_refit(), in the same unit; 0 if there was no refit
        Bounds3 bounds;
    };
    Figures finish();

    /// Queues a refit of the tree from the last finish() to triangles that have moved. They have the same number and
    /// order. finish() then returns their bounds and the present cost.
    void start_refit(const BvhTriangle* moved);
    /// Allocates memory for start_refit(), which otherwise does so at its first call.
    void reserve_refit();

    /// The tree's device view and a host copy, after finish().
    CompressedBvhView view() const;
    CompressedBvh download() const;

    /// Clears and returns the working memory of the stages, with the binary tree before the conversion, for tests.
    hploc::Climb prepare_climb() const;
    hploc::EmitWide prepare_emit();
    std::vector<hploc::ClusterNode> download_clusters() const { return nodes_.download(); }

    /// Builds with equal halves of the curve from now on, as after a tree that was too deep, for tests.
    void set_balanced(bool balanced) { balanced_ = balanced; }

private:
    void make_codes(Sink& sink);
    void climb(Sink& sink);
    void emit(Sink& sink);

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
    // Refit data, made by the first refit: parent of each node, children that are done, and boxes.
    Buffer<uint32_t> parents_, children_, arrived_;
    Buffer<NodeBox> boxes_;
    Buffer<RefitResult> refitted_;
    bool are_linked_ = false, is_refitted_ = false;
};

/// Builds from triangles on the host and copies the tree back; used by the laboratory. On the CPU `sink` may
/// end it.
CompressedBvh build_compressed_bvh(Queue& queue, std::span<const BvhTriangle> triangles, Sink& sink = nobody());

} // namespace pertev

#pragma once

// The tree of a mesh whose vertices move on the device, there: built once, then fitted to where they are, and built
// anew when fits have made it kMaxRefitCost times as dear as it was. Compressed nodes are built on the device too
// (hploc/device_builder.h); those that a CPU walks by its builders, on all threads.

#include <cstdint>
#include <vector>

#include "accel/bvh/wide_bvh.h"
#include "device/buffer.h"
#include "device_scene/deformed_mesh.h"
#include "tracer/built_structure.h"
#include "tracer/hploc/device_builder.h"
#include "tracer/hploc/refit_upwards.h"

namespace pertev {

/// Whether trees of this layout are kept so; others are built on the host when vertices move.
bool can_deform(TreeLayout layout, bool on_cuda);

/// The triangles as they are now, on the host.
std::vector<BvhTriangle> read_triangles(Queue& queue, const DeformedMesh& mesh);

/// Of compressed nodes.
class DeformingCompressed {
public:
    using View = CompressedBvhView;
    DeformingCompressed(Queue& queue, uint32_t triangles);

    /// Gives the work to the queue.
    void start(const DeformedMesh& mesh);
    /// Waits for it; returns the bounds of all triangles.
    Bounds3 finish();
    View view() const { return builder_.view(); }
    uint32_t builds() const { return builds_; } // so far

private:
    void build();

    Queue& queue_;
    Buffer<BvhTriangle> triangles_; // in the mesh's order
    DeviceBuilder builder_;
    float built_cost_ = 0;
    uint32_t builds_ = 0;
};

/// Of eight boxes a node, with leaves for four triangles at once; on a CPU, in the host's memory as all its trees.
class DeformingWide {
public:
    using View = WideBvhView<8>;
    DeformingWide(Queue& queue, uint32_t triangles);

    void start(const DeformedMesh& mesh);
    Bounds3 finish() const { return tree_.bounds; }
    View view() const { return view_of(tree_); }
    uint32_t builds() const { return builds_; }

private:
    void build(const DeformedMesh& mesh);
    void refit(const DeformedMesh& mesh);

    Queue& queue_;
    WideBvh<8> tree_;
    std::vector<uint32_t> parents_, children_, arrived_; // of each node
    std::vector<NodeBox> boxes_;
    float built_cost_ = 0;
    uint32_t builds_ = 0;
};

} // namespace pertev

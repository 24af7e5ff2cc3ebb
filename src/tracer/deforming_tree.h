#pragma once

// BLASes of meshes whose vertices move on the device. Each is built once, then refitted, and rebuilt once refits have
// raised its SAH cost to kMaxRefitCost times that of the build. Compressed nodes are built on the device
// (hploc/device_builder.h); the wide nodes of the CPU are built by the host's builders on all threads.

#include <cstdint>
#include <vector>

#include "accel/bvh/wide_bvh.h"
#include "device/buffer.h"
#include "device_scene/deformed_mesh.h"
#include "tracer/built_structure.h"
#include "tracer/hploc/device_builder.h"
#include "tracer/hploc/refit_upwards.h"

namespace pertev {

/// Returns whether trees of this layout are refitted on the device. Others are rebuilt on the host when vertices move.
bool can_deform(TreeLayout layout, bool on_cuda);

/// Copies the mesh's current triangles to the host.
std::vector<BvhTriangle> read_triangles(Queue& queue, const DeformedMesh& mesh);

/// A tree of compressed nodes.
class DeformingCompressed {
public:
    using View = CompressedBvhView;
    DeformingCompressed(Queue& queue, uint32_t triangles);

    /// Queues a build or a refit.
    void start(const DeformedMesh& mesh);
    /// Waits for the queue and returns the bounds of all triangles.
    Bounds3 finish();
    View view() const { return builder_.view(); }
    uint32_t builds() const { return builds_; } // builds so far

private:
    void build();

    Queue& queue_;
    Buffer<BvhTriangle> triangles_; // in the mesh's order
    DeviceBuilder builder_;
    float built_cost_ = 0;
    uint32_t builds_ = 0;
};

/// A tree of eight-wide nodes with leaves for four triangles at once. It is for the CPU, thus in host memory.
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
    std::vector<uint32_t> parents_, children_, arrived_; // [node]
    std::vector<NodeBox> boxes_;
    float built_cost_ = 0;
    uint32_t builds_ = 0;
};

} // namespace pertev

#pragma once

// Refits a tree of compressed nodes to triangles that have moved. Its topology does not change. Each box equals the
// bounds of its triangles to the bit.

#include <cstdint>

#include "accel/bvh/compress_boxes.h"
#include "accel/bvh/compressed_bvh.h"
#include "accel/hploc/cluster_tree.h"
#include "accel/hploc/leaves.h"
#include "tracer/hploc/refit_upwards.h"

namespace pertev::hploc {

/// The stage that counts the inner children of each node and stores their links to it. The caller sets the root's
/// entry.
struct LinkParents {
    const CompressedBvhNode* nodes;
    uint32_t *parents, *children;

    HD void operator()(uint32_t i) const {
        const uint32_t count = count_ones(inner_slots(nodes[i]));
        children[i] = count;
        for (uint32_t k = 0; k < count; ++k) parents[nodes[i].child_base + k] = i;
    }
};

/// The stage that copies the new vertices of each triangle of the tree.
struct MoveTriangles {
    const BvhTriangle* moved; // in the order of the triangles that the tree was built from
    const uint32_t* sources;  // [triangle of the tree] index into `moved`
    BvhTriangle* triangles;

    HD void operator()(uint32_t i) const {
        BvhTriangle triangle = load_triangle(moved + sources[i]);
        triangle.flags = (triangle.flags & ~kLastInLeaf) | (triangles[i].flags & kLastInLeaf);
        triangles[i] = triangle;
    }
};

/// The stage that refits the boxes, with one call per node.
struct RefitNodes {
    CompressedBvhNode* nodes;
    const BvhTriangle* triangles;
    UpwardLinks links;
    float node_cost, triangle_cost; // from CollapseSettings

    HD void operator()(uint32_t i) const {
        links.climb_from(i, [this](uint32_t node) { return fit(node); });
    }

private:
    HD NodeBox fit(uint32_t i) const {
        CompressedBvhNode node = nodes[i];
        Bounds3 slots[8], all;
        uint32_t child = node.child_base, triangle = node.triangle_base;
        float cost = 0;
        for (uint32_t bit = 0; bit < 24; ++bit) {
            if (node.triangles >> bit & 1u) slots[bit % 8].extend(hploc::bounds_of(triangles[triangle++]));
        }
        for (uint32_t s = 0; s < 8; ++s) {
            if (inner_slots(node) >> s & 1u) {
                const NodeBox box = links.box_of(child++);
                slots[s] = {box.lo, box.hi};
                cost += box.cost;
            } else {
                const auto held = static_cast<float>(count_ones(triangles_of_slots(node, 1u << s)));
                cost += slots[s].half_area() * (triangle_cost * held);
            }
            all.extend(slots[s]);
        }
        compress_boxes(node, all, slots);
        nodes[i] = node;
        return {all.lo, cost + all.half_area() * node_cost, all.hi, 0};
    }
};

} // namespace pertev::hploc

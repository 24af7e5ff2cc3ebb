#pragma once

// Traversal of an octree: existing children are visited front to back; with the direction's signs s that is child k ^
// s for k = 0 to 7.
//
// Source: Knoll, "A Survey of Octree Volume Rendering Methods", 2006 (the order by signs). Why no hit is lost:
// cell_span.h; a node's three planes clip its span as three nodes of a kd-tree would. The traversal ends when all
// pending cells are entered beyond the nearest hit, not at the first cell with a hit. A stack entry holds the rest of
// a node's work; planes are recomputed on the way back, which is exact and cheaper than storing them.

#include <cstdint>

#include "accel/octree/octree.h"
#include "base/host_device.h"
#include "trace/cells/cell_span.h"
#include "trace/intersect/test_references.h"
#include "trace/traversal/traversal_counter.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

template <TraversalOptions kOptions>
struct OctreeTraversal {
    using Tree = OctreeView;
    using Tests = TestsOf<kOptions>;

    struct Level {
        OctreeNode node;
        uint32_t next; // next of the eight children, in the ray's order
        CellSpan span;
    };

    template <class Visitor, class Counter>
    HD static bool traverse(const OctreeView& tree, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        if (tree.nodes == nullptr) return false;
        const typename Tests::Boxes boxes = Tests::make_boxes(ray, tree.bounds.max_abs());
        const typename Tests::Triangles prepared = Tests::make_triangles(ray);
        const uint32_t backwards =
            (boxes.inv.x < 0 ? 1u : 0u) | (boxes.inv.y < 0 ? 2u : 0u) | (boxes.inv.z < 0 ? 4u : 0u);
        const uint32_t signs = kOptions.near_first ? backwards : 0;
        Level stack[kMaxOctreeDepth];
        int size = 0;
        OctreeCell cell = {0, 0, 0, 0.5f * tree.side};
        uint32_t at = 0;
        CellSpan span = span_of_bounds(boxes, tree.bounds, ray.t_min, ray.t_max);
        if (!is_entered(span, skip_beyond<kOptions>(visitor, ray))) return false;
        for (;;) {
            counter.add_node(tree.nodes + at);
            const OctreeNode node = tree.nodes[at];
            if (!node.is_leaf()) {
                stack[size++] = {node, 0, span};
            } else {
                if (test_references<Tests>(tree.triangles, tree.references + node.first, node.count(), ray, prepared,
                                           instance, visitor, counter)) {
                    return true;
                }
                if (size == 0) return false; // the root is a leaf
                cell = cell.parent();
            }
            for (;;) { // `cell` belongs to the topmost level
                Level& top = stack[size - 1];
                const uint32_t k =
                    next_child(top, boxes, cell.centre(tree.corner), signs, skip_beyond<kOptions>(visitor, ray), span);
                if (k < 8) {
                    at = top.node.child(k);
                    cell = cell.child(k);
                    break;
                }
                if (--size == 0) return false;
                cell = cell.parent();
            }
        }
    }

private:
    /// Finds the next child that may hold a relevant hit, and its span. Returns 8 if there is none.
    HD static uint32_t next_child(Level& level, const RayBoxes& boxes, Vec3 centre, uint32_t signs, float t_limit,
                                  CellSpan& span) {
        if (!(level.span.entry <= t_limit)) return 8;
        const PlaneCrossing x = cross_plane(boxes, 0, centre.x);
        const PlaneCrossing y = cross_plane(boxes, 1, centre.y);
        const PlaneCrossing z = cross_plane(boxes, 2, centre.z);
        while (level.next < 8) {
            const uint32_t k = level.next++ ^ signs;
            if (!level.node.has_child(k)) continue;
            span = k & 1 ? span_above(level.span, x) : span_below(level.span, x);
            span = k & 2 ? span_above(span, y) : span_below(span, y);
            span = k & 4 ? span_above(span, z) : span_below(span, z);
            if (is_entered(span, t_limit)) return k;
        }
        return 8;
    }
};

} // namespace pertev
